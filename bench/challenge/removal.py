"""How much of the mismatch a diagnosis removes on sealed links, beside what the truth removes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.challenge.cases import Case
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import weight_of
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.data.observables import RANGE, window_of
from bench.discrepancy.method import Diagnosis

Floats = NDArray[np.float64]
MEMBERS = 16


def removed(case: Case, found: Diagnosis) -> tuple[float, float]:
    """Return how far the mismatch of sealed rows falls: by the diagnosis, and by the truth.

    Mismatch: the excess of the CRPS over the truth's, per observable in units of the truth's,
    weighted as the diagnosis weighs observables. The truth: the simulated table as it would be
    with what is hidden in it. Observables that the truth does not improve by a tenth take no part.
    """
    before, after = found.confirmed.before, found.confirmed.after
    window = window_of(case.recorded.frame)
    comparison = TableComparison(case.truth.frame, window, 0)
    true = comparison.ensemble(found.confirmed.view, (), MEMBERS)
    totals = [0.0, 0.0]
    for name in before.names:
        if name not in true.names or name not in after.names:
            continue
        was, now, best = (_score(one, name) for one in (before, after, true))
        if np.isfinite([was, now, best]).all() and was > 1.1 * best > 0:
            weight = weight_of(name) if name != RANGE else 1.0
            totals[0] += weight * (was - now) / best
            totals[1] += weight * (was - best) / best
    return totals[0], totals[1]


def _score(ensemble: Ensemble, name: str) -> float:
    """Return the mean CRPS of an observable in its unit."""
    place = ensemble.place(name)
    one = replace(
        ensemble,
        names=(name,),
        units=(ensemble.units[place],),
        versions=ensemble.versions[..., place : place + 1],
    )
    return float(np.nanmean(one.scores()))
