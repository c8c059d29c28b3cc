"""Columns of the user's own that were taken as measured with the range, and are not.

What scatters from row to row is set aside, for a receiver's quality figure that follows the error
would else explain it. But such a figure follows the noise too. Where a law over a column explains
what a set of causes leaves, and what is left then scatters just as simulated rows do, the column
says nothing of the noise: it was known before.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.law.material import material
from bench.discrepancy.sets.beside import nats_with, weighed_with
from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.formed import laws_of
from bench.discrepancy.sets.settings import AS_SIMULATED, LEAST_WEIGHT, MISTAKEN_NATS

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]


def mistaken(
    contest: Contest, best: Set, doubtful: pd.DataFrame, ensemble: Ensemble
) -> tuple[str, ...]:
    """Return which `doubtful` columns [all rows] are known before, by what `best` leaves.

    `ensemble` has the simulated versions of the contest's view.
    """
    made = contest.evidence.of(best)
    rest = [contest.evidence.response(made, one) for one in best]
    left = contest.evidence.left_m - np.sum([np.zeros(len(contest.known)), *rest], axis=0)
    rows, links = contest.rows.rows[contest.known], contest.rows.links[contest.known]
    noise = _scatter(ensemble, contest.known)
    taken = np.flatnonzero(contest.evidence.weights > LEAST_WEIGHT)
    out = []
    for name in map(str, doubtful.columns):
        every = material(doubtful[[name]].iloc[rows].reset_index(drop=True), left, links)
        if not every.columns or len(every.residual_m) < len(left):
            continue
        for law in islice(laws_of(every, every.take(taken)), 1):
            lead = nats_with(contest, best, {law.name: law.parts}) - law.pays - contest.nats(best)
            after = weighed_with(contest, best, {law.name: law.parts}).variance_m2
            if lead > MISTAKEN_NATS and AS_SIMULATED[0] < after / noise < AS_SIMULATED[1]:
                out.append(name)
    return tuple(out)


def _scatter(ensemble: Ensemble, known: NDArray[np.intp]) -> float:
    """Return the variance of simulated ranges of the same row, infinite where there is one each."""
    versions = ensemble.versions[1:, known, ensemble.place(RANGE)]
    each = np.nanvar(versions, axis=0, ddof=1) if len(versions) > 1 else np.zeros(0)
    return float(np.nanmedian(each)) or np.inf if each.size else np.inf
