"""Proper scores of an ensemble and their uncertainty over links.

The ensemble CRPS is four lines of numpy; properscoring is no longer maintained and scoringrules
would bring a second array layer, so neither is a dependency.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.settings import (
    BOOTSTRAP_DRAWS,
    CENTRAL_95,
    ONE_SIDED_95,
    QUANTILE_DRAWS,
    TWO_SIDED_95,
)
from bench.text import significant

Floats = NDArray[np.float64]
LIKELIHOOD: Final = "nats of likelihood"
"""The unit of what links speak for one by one; a gain of the score has nats of its own."""


@dataclass(frozen=True)
class Estimate:
    """A figure with its 95 % interval (cluster bootstrap over links) and unit."""

    value: float
    low: float
    high: float
    unit: str = ""

    @property
    def above_zero(self) -> bool:
        """True where the whole interval is above zero."""
        return self.low > 0

    @property
    def likely_above_zero(self) -> bool:
        """True where the one-sided 95 % bound is above zero (the interval taken as normal)."""
        return self.value - (self.value - self.low) * ONE_SIDED_95 / TWO_SIDED_95 > 0

    def __str__(self) -> str:
        if np.isnan(self.value):  # nothing was compared
            return "unknown"
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        value, low, high = (significant(one, 3) for one in (self.value, self.low, self.high))
        return f"{value}{unit} [{low}, {high}]"


def crps(ensemble: Floats, recorded: Floats) -> Floats:
    """Return the continuous ranked probability score per value, in the value's unit.

    `ensemble` [m, ...] and `recorded` [...]; the fair estimator of Ferro (2014),
    E|X - y| - E|X - X'| / 2 with E|X - X'| over different members, so m does not bias it.
    NaN where the recorded value or any member is NaN.
    """
    m = len(ensemble)
    if m < 2:
        raise ValueError("a score needs at least two ensemble members")
    ordered = np.sort(ensemble, axis=0)
    rank = (2 * np.arange(1, m + 1) - m - 1).reshape((m,) + (1,) * (ensemble.ndim - 1))
    spread = (rank * ordered).sum(axis=0) * 2 / (m * (m - 1))
    return np.asarray(np.abs(ensemble - recorded).mean(axis=0) - spread / 2)


def energy_score(ensemble: Floats, recorded: Floats) -> Floats:
    """Return the energy score per row (Gneiting and Raftery 2007) of vectors.

    `ensemble` [m, n, p], `recorded` [n, p]: E|X - y| - E|X - X'| / 2 in Euclidean norm, fair.
    """
    m = len(ensemble)
    near = np.linalg.norm(ensemble - recorded, axis=-1).mean(axis=0)
    apart = sum(np.linalg.norm(ensemble - ensemble[i], axis=-1).sum(axis=0) for i in range(m))
    return np.asarray(near - apart / (2 * m * (m - 1)))


def cluster_bootstrap(
    values: Floats,
    links: NDArray[np.intp],
    seed: int,
    unit: str = "",
    statistic: Callable[[Floats, Floats], Floats] | None = None,
    draws: int = BOOTSTRAP_DRAWS,
) -> Estimate:
    """Return the mean of `values` [n] with a 95 % interval, resampling whole links.

    `links` [n] are codes 0..L-1. `statistic` maps per-draw (sums [draws], counts [draws]) to the
    figure [draws]; the mean by default. With fewer than two links the interval is infinite.
    """
    known = np.isfinite(values)
    _, code = np.unique(links[known], return_inverse=True)
    figure = statistic or (lambda total, count: total / np.maximum(count, 1))
    if not known.any():
        return Estimate(np.nan, -np.inf, np.inf, unit)
    sums = np.asarray(np.bincount(code, values[known]), np.float64)
    counts = np.asarray(np.bincount(code), np.float64)
    centre = float(figure(sums.sum(keepdims=True), counts.sum(keepdims=True))[0])
    if len(sums) < 2:
        return Estimate(centre, -np.inf, np.inf, unit)
    rng = np.random.default_rng(seed)
    weight = rng.multinomial(len(sums), np.full(len(sums), 1 / len(sums)), size=draws)
    drawn = figure(np.asarray(weight @ sums), np.asarray(weight @ counts))
    # A percentile interval over few clusters is too short by about sqrt(L / (L - 1)) (Bessel).
    wide = np.sqrt(len(sums) / (len(sums) - 1))
    low, high = np.percentile(drawn, CENTRAL_95)
    return Estimate(centre, centre + (low - centre) * wide, centre + (high - centre) * wide, unit)


def cluster_quantile(
    values: Floats, links: NDArray[np.intp], share: float, seed: int, unit: str = ""
) -> Estimate:
    """Return a quantile of `values` [n] (NaN left out) with a 95 % interval over whole links."""
    known = np.isfinite(values)
    if not known.any():
        return Estimate(np.nan, -np.inf, np.inf, unit)
    ordered = values[known][order := np.argsort(values[known])]
    code = np.unique(links[known], return_inverse=True)[1][order]
    count = int(code.max()) + 1
    rng = np.random.default_rng(seed)
    weight = rng.multinomial(count, np.full(count, 1 / count), size=QUANTILE_DRAWS)
    total = np.cumsum(np.concatenate([np.ones((1, count), np.int64), weight])[:, code], axis=1)
    place = (total < share * total[:, -1:]).sum(axis=1)
    drawn = ordered[np.minimum(place, len(ordered) - 1)]
    low, high = np.percentile(drawn[1:], CENTRAL_95)
    return Estimate(float(drawn[0]), float(low), float(high), unit)
