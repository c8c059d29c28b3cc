"""Before and after on links that nothing was searched, fitted or chosen on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.discrepancy.compare.calibration import rank_distance, separability
from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import CONFIRM_FIRST, CONFIRM_MEMBERS


@dataclass(frozen=True)
class Confirmed:
    """Before and after on links that nothing was tuned on.

    `gain` in nats (see `skill`); `mae_before_m`, `mae_after_m`: mean |recorded error - ensemble
    mean| in metres; `auc_before`, `auc_after`: how well a classifier tells recorded from simulated
    rows (0.5 = not at all); `ranks_before`, `ranks_after`: deviation of ensemble ranks from
    uniform (Kolmogorov distance, 0 = calibrated). `before` and `after` are the ensembles.
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


def confirm(comparison: Comparison, held: View, added: Added, seed: int) -> Confirmed:
    """Compare before and after on held-out rows."""
    before = comparison.ensemble(held, (), CONFIRM_MEMBERS, CONFIRM_FIRST)
    after = before
    if added:
        after = comparison.ensemble(held, added, CONFIRM_MEMBERS, CONFIRM_FIRST)
    return Confirmed(
        links=len(np.unique(held.links)),
        rows=len(held.rows),
        gain=gain_interval(tally(before), tally(after), seed),
        mae_before_m=_mae(before, seed),
        mae_after_m=_mae(after, seed),
        auc_before=separability(before, seed),
        auc_after=separability(after, seed),
        ranks_before=rank_distance(before),
        ranks_after=rank_distance(after),
        before=before,
        after=after,
        view=held,
    )


def improves(comparison: Comparison, held: View, added: Added, richer: Added, seed: int) -> bool:
    """Return whether richer effects score better on held-out working links, beyond doubt."""
    first = CONFIRM_FIRST - CONFIRM_MEMBERS
    left, right = (
        tally(comparison.ensemble(held, effects, CONFIRM_MEMBERS, first))
        for effects in (added, richer)
    )
    return gain_interval(left, right, seed).above_zero


def _mae(ensemble: Ensemble, seed: int) -> Estimate:
    """Return the mean |recorded range error - ensemble mean| in metres."""
    if RANGE not in ensemble.names:
        return Estimate(np.nan, np.nan, np.nan, "m")
    left = np.abs(ensemble.residual_of(RANGE))
    return cluster_bootstrap(left, ensemble.links, seed, "m")
