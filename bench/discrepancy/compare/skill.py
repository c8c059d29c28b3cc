"""One figure of merit for many observables: how much better one ensemble scores than another.

gain = sum over observables of weight x log(CRPS of the reference / CRPS of the candidate), each
CRPS averaged over rows. A gain of 0.1 in one observable of weight 1 is a tenth off its score.
Logarithms make metres and decibels comparable and cannot be driven by one observable's unit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import (
    CENTRAL_95,
    FEATURE_WEIGHT,
    GAIN_DRAWS,
    LEAST_CRPS,
    LEVEL_WEIGHT,
    LINEAR_BELOW,
    PROFILE_WEIGHT,
    RANGE_WEIGHT,
    RESOLUTION,
)

Floats = NDArray[np.float64]
_POWERS = ("rx_power_dbm", "first_path_power_dbm", "energy_db", "max_amplitude_db")


def weight_of(name: str) -> float:
    """Return the weight of an observable: correlated ones share theirs."""
    if name == RANGE:
        return RANGE_WEIGHT
    if name in _POWERS or name in ("noise_std", "preamble_count"):
        return LEVEL_WEIGHT
    return PROFILE_WEIGHT if name.startswith("profile_db") else FEATURE_WEIGHT


@dataclass(frozen=True)
class Tally:
    """CRPS sums and row counts per link and observable, both [L, p]; `names` [p]."""

    names: tuple[str, ...]
    sums: Floats
    counts: Floats

    def keep(self, names: tuple[str, ...]) -> Tally:
        """Return the tally of some observables."""
        which = [self.names.index(name) for name in names]
        return Tally(names, self.sums[:, which], self.counts[:, which])

    def beside(self, other: Tally) -> Tally:
        """Return the tally of the links of both, of the observables that both have."""
        names = tuple(name for name in self.names if name in other.names)
        ours, theirs = self.keep(names), other.keep(names)
        return Tally(
            names,
            np.concatenate([ours.sums, theirs.sums]),
            np.concatenate([ours.counts, theirs.counts]),
        )


def tally(ensemble: Ensemble) -> Tally:
    """Return CRPS + resolution of an ensemble, summed over the rows of each link."""
    scores = ensemble.scores()
    known = np.isfinite(scores)
    code = np.unique(ensemble.links, return_inverse=True)[1]
    links = int(code.max()) + 1
    least = np.array([RESOLUTION.get(unit, 0.0) for unit in ensemble.units])
    values = np.where(known, np.maximum(scores, 0.0) + least, 0.0)
    sums, counts = (_by_link(each, code, links) for each in (values, known))
    return Tally(ensemble.names, sums, counts)


def _by_link(values: Floats | NDArray[np.bool_], code: NDArray[np.intp], links: int) -> Floats:
    """Return the sums [L, p] of values [n, p] over the rows of each link, by its code [n]."""
    columns = values.shape[1]
    cell = (code[:, None] * columns + np.arange(columns)).ravel()
    made = np.bincount(cell, values.ravel(), minlength=links * columns)
    return np.asarray(made.reshape(links, columns), np.float64)


def _weighted_logs(part: Tally, draws: NDArray[np.int64]) -> Floats:
    """Return weight x log mean CRPS per draw and observable, [draws, p]."""
    mean = (draws @ part.sums) / np.maximum(draws @ part.counts, 1)
    weights = np.array([weight_of(name) for name in part.names])
    return np.asarray(weights * np.log(np.maximum(mean, LEAST_CRPS)))


def gains(reference: Tally, candidate: Tally) -> dict[str, float]:
    """Return the gain of each observable both have (in nats, weight included)."""
    names = tuple(n for n in reference.names if n in candidate.names)
    one = np.ones((1, len(reference.sums)), np.int64)
    left = _weighted_logs(reference.keep(names), one)
    right = _weighted_logs(candidate.keep(names), one)
    return dict(zip(names, (left - right)[0].tolist(), strict=True))


def gain(reference: Tally, candidate: Tally) -> float:
    """Return the total gain of `candidate` over `reference`."""
    return float(sum(gains(reference, candidate).values()))


def fall(reference: Tally, candidate: Tally) -> float:
    """Return by which share of the reference the scores fall: weighted, summed over observables.

    Unlike a gain it cannot grow without bound where an observable hardly scatters, so it says how
    much of a mismatch is gone.
    """
    names = tuple(n for n in reference.names if n in candidate.names)
    one = np.ones((1, len(reference.sums)), np.int64)
    return float(_weighted_differences(reference.keep(names), candidate.keep(names), one)[0])


def gain_interval(
    reference: Tally, candidate: Tally, seed: int, names: tuple[str, ...] | None = None
) -> Estimate:
    """Return the gain with a 95 % interval, both scored on the same bootstrapped links.

    `names` restricts it to some observables. The interval of a gain of less than a nat comes from
    the differences of the scores, not of their logarithms: where few links carry most of the
    score, the logarithm of their resampled mean is so skewed that it hides a difference of sign.
    """
    shared = tuple(n for n in reference.names if n in candidate.names)
    chosen = shared if names is None else tuple(n for n in shared if n in names)
    links = len(reference.sums)
    pick = np.random.default_rng(seed).multinomial(
        links, np.full(links, 1 / links), size=GAIN_DRAWS
    )
    draws = np.concatenate([np.ones((1, links), np.int64), pick])
    left, right = reference.keep(chosen), candidate.keep(chosen)
    total = (_weighted_logs(left, draws) - _weighted_logs(right, draws)).sum(axis=1)
    value = float(total[0])
    if links < 2:
        return Estimate(value, -np.inf, np.inf, "nats")
    linear = _weighted_differences(left, right, draws)
    if abs(value) < LINEAR_BELOW and linear[0] * value > 0:
        total = linear * (value / linear[0])
    wide = np.sqrt(links / (links - 1))
    low, high = np.percentile(total[1:], CENTRAL_95) - value
    return Estimate(value, float(value + wide * low), float(value + wide * high), "nats")


def alike(reference: Tally, one: Tally, other: Tally) -> float:
    """Return the correlation over links of what two candidates gain: 1 for the same links.

    Two that gain as much in total are not the same thing where they gain it on different rows.
    """
    names = tuple(n for n in reference.names if n in one.names and n in other.names)
    each = np.eye(len(reference.sums), dtype=np.int64)
    left = reference.keep(names)
    mine, its = (_weighted_differences(left, c.keep(names), each) for c in (one, other))
    if min(mine.std(), its.std()) < LEAST_CRPS:
        return 1.0
    return float(np.corrcoef(mine, its)[0, 1])


def _weighted_differences(left: Tally, right: Tally, draws: NDArray[np.int64]) -> Floats:
    """Return the weighted sum of (mean CRPS of left - of right) / mean of left, per draw."""
    rows = np.maximum(draws @ left.counts, 1)
    change = (draws @ left.sums) / rows - (draws @ right.sums) / np.maximum(draws @ right.counts, 1)
    typical = np.maximum(left.sums.sum(axis=0) / np.maximum(left.counts.sum(axis=0), 1), LEAST_CRPS)
    weights = np.array([weight_of(name) for name in left.names])
    return np.asarray((weights * change / typical).sum(axis=1))
