"""Before and after on links that nothing was searched, fitted or chosen on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from bench.discrepancy.compare.calibration import rank_distance, separability
from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap, cluster_quantile
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.reuse import standing
from bench.discrepancy.compare.skill import Tally, gain_interval, tally
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE, Floats
from bench.discrepancy.settings import (
    CONFIRM_FIRST,
    CONFIRM_MEMBERS,
    EASIER_AUC,
    FARTHER_SHARE,
    FEWEST_AUC_LINKS,
    HIGH_QUANTILE,
    LEAST_NOTICED_M,
    NOTICED_SHARE,
)
from bench.physics.effect import Effect

NO_GAIN: Final = Estimate(0.0, 0.0, 0.0, "nats")


@dataclass(frozen=True)
class Confirmed:
    """Before and after on links that nothing was tuned on.

    `gain` in nats (see `skill`); `mae_before_m`, `mae_after_m`: mean |recorded error - ensemble
    median| in metres; `auc_before`, `auc_after`: how well a classifier tells recorded rows from
    simulated ones (0.5 = not at all); `ranks_before`, `ranks_after`: deviation of ensemble ranks
    from uniform (Kolmogorov distance, 0 = calibrated). `before` and `after` are the ensembles.
    `median_...`, `high_...`: median and 90th percentile of the same as `mae_...`; `nearer_m`: how
    much smaller it is after, row by row (positive is better). `ranges` and `waves` are the gains
    of ranges alone and of all but them.
    """

    links: int
    rows: int
    gain: Estimate
    mae_before_m: Estimate
    mae_after_m: Estimate
    auc_before: float
    auc_after: float
    ranks_before: float
    ranks_after: float
    before: Ensemble
    after: Ensemble
    view: View
    median_before_m: Estimate
    median_after_m: Estimate
    high_before_m: Estimate
    high_after_m: Estimate
    nearer_m: Estimate
    ranges: Estimate = NO_GAIN
    waves: Estimate = NO_GAIN

    @property
    def better(self) -> str:
        """What the score is better in, in words: what is beyond doubt, else what is better."""
        parts = {"the scatter of ranges": self.ranges, "levels or waveforms": self.waves}
        sure = [words for words, gained in parts.items() if gained.above_zero]
        likely = [words for words, gained in parts.items() if gained.value > 0]
        return " and ".join(sure or likely) or "all observables together"

    @property
    def farther(self) -> bool:
        """Whether ranges are worse after, beyond chance or by so much that chance is no comfort.

        So much: in the mean or in the median.
        """
        means, medians = (
            (getattr(self, f"{one}_before_m").value, getattr(self, f"{one}_after_m").value)
            for one in ("mae", "median")
        )
        return is_farther(self.nearer_m, means, medians)

    @property
    def easier(self) -> str:
        """In words that rows are told from simulated ones more easily after, "" where not surely.

        No score of observables one by one, a mean over them, need see that two of them no longer go
        together, or that what one effect overshoots another takes back.
        """
        before, after = (max(one, 0.5) for one in (self.auc_before, self.auc_after))
        if self.links < FEWEST_AUC_LINKS or not after - before > EASIER_AUC:
            return ""
        return (
            f", though recorded rows are told from simulated ones more easily "
            f"(AUC {self.auc_before:.2f} -> {self.auc_after:.2f})"
        )

    @property
    def serves(self) -> bool:
        """Whether score and typical range error are no worse after than before."""
        return self.gain.value > 0 and not self.farther


Pair = tuple[float, float]


@dataclass(frozen=True)
class Served:
    """What some effects do for held-out links: gain in nats, and whether ranges are farther.

    `before_m` is the mean |recorded - simulated| range error without any, `missed_m` with them,
    `medians_m` the median of both; `waves` the gain of all that is compared but the range.
    `surely`: ranges are farther beyond chance.
    """

    gain: Estimate
    farther: bool
    missed_m: float
    before_m: float = float("nan")
    waves: Estimate = NO_GAIN
    medians_m: Pair = (0.0, 0.0)
    surely: bool = False

    @property
    def idle(self) -> bool:
        """Whether the effects do nothing at all in these rows, which then tell nothing of them."""
        same = (self.before_m, self.medians_m[0]) == (self.missed_m, self.medians_m[1])
        return same and self.gain.low == self.gain.high == 0

    def __str__(self) -> str:
        if self.idle:
            return "it changes nothing in sealed links: what it acts on is not there, or overruled"
        score = "better" if self.gain.value > 0 else "no better"
        which, means = "mean", (self.before_m, self.missed_m)
        if means[1] <= means[0] and much_farther(*self.medians_m):  # it is the typical link that is
            which, means = "median", self.medians_m
        change = f"{means[0]:.3g} -> {means[1]:.3g} m"
        worse = f", but ranges are worse: {which} |recorded - simulated| {change}"
        return f"with it the score is {score}{worse if self.farther else ''}, on sealed links"

    @property
    def serves(self) -> bool:
        """Whether score and typical range error are no worse than without any."""
        return self.gain.value > 0 and not self.farther

    @property
    def rank(self) -> tuple[bool, bool, float]:
        """What is better comes later: what serves, then what spares the ranges, then the score."""
        near = -self.missed_m if self.farther else self.gain.value
        return self.serves, not self.farther, near


def served(comparison: Comparison, held: View, added: Added, seed: int) -> Served:
    """Return what effects do for held-out rows."""
    before, after = (
        comparison.ensemble(held, some, CONFIRM_MEMBERS, CONFIRM_FIRST) for some in ((), added)
    )
    centred = _centred(comparison, held, added, after)
    misses = [_misses(before), _misses(centred)]
    typical = misses[0], _misses(_typical(comparison, held, added, centred))
    nearer = cluster_bootstrap(misses[0] - misses[1], held.links, seed, "m")
    means, medians = ((one(a), one(b)) for one, (a, b) in ((_mean, misses), (_median, typical)))
    scores = tally(before), tally(after)
    gained, waves = gain_interval(*scores, seed), _of_waves(*scores, seed)
    farther, surely = is_farther(nearer, means, medians), surely_farther(nearer, means)
    return Served(gained, farther, means[1], means[0], waves, medians, surely)


def _of_waves(before: Tally, after: Tally, seed: int) -> Estimate:
    """Return the gain of all that is compared but the range; none where that is all."""
    names = tuple(name for name in before.names if name != RANGE and name in after.names)
    return gain_interval(before, after, seed, names) if names else NO_GAIN


def _of_ranges(before: Tally, after: Tally, seed: int) -> Estimate:
    """Return the gain of ranges alone; none where none are compared."""
    both = RANGE in before.names and RANGE in after.names
    return gain_interval(before, after, seed, (RANGE,)) if both else NO_GAIN


def _centred(comparison: Comparison, held: View, added: Added, made: Ensemble) -> Ensemble:
    """Return the ensemble without what only scatters: of so few versions it moves the median.

    Nor with what rounds: where both sides lie on one grid, they differ by whole steps.
    """
    firm = tuple(effect for effect in added if not _only_scatters(effect))
    return _of(comparison, held, added, made, firm)


def _typical(comparison: Comparison, held: View, added: Added, centred: Ensemble) -> Ensemble:
    """Return the ensemble without what strikes links at random, either.

    Of ranges alone. A typical link is spared, and with a third of the versions struck the median of
    all is an upper end of what spared ones say.
    """
    if held.waveform or all(type(effect).strikes is None for effect in added):
        return centred
    firm = tuple(e for e in added if type(e).strikes is None and not _only_scatters(e))
    return _of(comparison, held, added, centred, firm)


def _only_scatters(effect: Effect) -> bool:
    """Return whether an effect moves every range by itself, and none of them for long."""
    return type(effect).independent or type(effect).marked


def _of(comparison: Comparison, held: View, added: Added, made: Ensemble, some: Added) -> Ensemble:
    """Return the ensemble of some effects: the one made with all that were added, if these are."""
    if len(some) == len(added):
        return made
    return comparison.ensemble(held, some, CONFIRM_MEMBERS, CONFIRM_FIRST)


def is_farther(nearer_m: Estimate, means_m: Pair, medians_m: Pair) -> bool:
    """Return whether range errors are larger after, by their means and medians before and after.

    Beyond chance, and by a share and millimetres that anybody would notice; or by so much that
    chance is no comfort.
    """
    sure = surely_farther(nearer_m, means_m)
    return sure or much_farther(*means_m) or much_farther(*medians_m)


def surely_farther(nearer_m: Estimate, means_m: Pair) -> bool:
    """Return whether range errors are larger after, beyond chance and as anybody would notice."""
    noticed = means_m[1] > max((1 + NOTICED_SHARE) * means_m[0], means_m[0] + LEAST_NOTICED_M)
    return bool(nearer_m.high < 0 and noticed)


def much_farther(before_m: float, after_m: float) -> bool:
    """Return whether a range error is larger after by more than a share that chance may excuse."""
    return after_m > (1 + FARTHER_SHARE) * before_m


def confirm(comparison: Comparison, held: View, added: Added, seed: int) -> Confirmed:
    """Compare before and after on held-out rows."""
    before = comparison.ensemble(held, (), CONFIRM_MEMBERS, CONFIRM_FIRST)
    after = before
    if added:
        after = comparison.ensemble(held, added, CONFIRM_MEMBERS, CONFIRM_FIRST)
    centred = _centred(comparison, held, added, after)
    left, right = _misses(before), _misses(centred)
    typical = _misses(_typical(comparison, held, added, centred))
    figures = {
        f"{name}_{word}_m": cluster_quantile(misses, held.links, share, seed, "m")
        for name, share, both in (
            ("median", 0.5, (left, typical)),
            ("high", HIGH_QUANTILE, (left, right)),
        )
        for word, misses in zip(("before", "after"), both, strict=True)
    }
    scores, apart = (tally(before), tally(after)), standing(comparison, held)
    return Confirmed(
        links=len(np.unique(held.links)),
        rows=len(held.rows),
        gain=gain_interval(*scores, seed),
        ranges=_of_ranges(*scores, seed),
        waves=_of_waves(*scores, seed),
        mae_before_m=_mae(before, seed),
        mae_after_m=_mae(centred, seed),
        auc_before=separability(before, seed, apart),
        auc_after=separability(after, seed, apart),
        ranks_before=rank_distance(before),
        ranks_after=rank_distance(after),
        before=before,
        after=after,
        view=held,
        nearer_m=cluster_bootstrap(left - right, held.links, seed, "m"),
        **figures,
    )


def improves(comparison: Comparison, held: View, added: Added, richer: Added, seed: int) -> bool:
    """Return whether richer effects serve better on held-out working links.

    The score is better, beyond doubt, and ranges are not much farther.
    """
    first = CONFIRM_FIRST - CONFIRM_MEMBERS
    made = [
        comparison.ensemble(held, effects, CONFIRM_MEMBERS, first) for effects in (added, richer)
    ]
    misses = [_misses(one) for one in made]
    if any(much_farther(*map(typical, misses)) for typical in (_mean, _median)):
        return False
    return gain_interval(tally(made[0]), tally(made[1]), seed).above_zero


def _misses(ensemble: Ensemble) -> Floats:
    """Return |recorded range error - ensemble median| in metres [n], NaN without ranges.

    The median is the forecast of which absolute errors are smallest (Gneiting 2011): where some
    links are struck at random, or some rows far off, a mean is of no row.
    """
    if RANGE not in ensemble.names:
        return np.full(len(ensemble.links), np.nan)
    middle = np.median(ensemble.simulated_of(RANGE), axis=0)
    return np.asarray(np.abs(ensemble.recorded[:, ensemble.place(RANGE)] - middle))


def _mean(values: Floats) -> float:
    return float(np.nanmean(values)) if np.isfinite(values).any() else float("nan")


def _median(values: Floats) -> float:
    return float(np.nanmedian(values)) if np.isfinite(values).any() else float("nan")


def _mae(ensemble: Ensemble, seed: int) -> Estimate:
    """Return the mean |recorded range error - ensemble median| in metres."""
    return cluster_bootstrap(_misses(ensemble), ensemble.links, seed, "m")
