"""What ranges of struck links say of the values of a strike.

Samples are told from the first path on, so that a straight path that comes late, or a reflection in
its place, hardly shows in them: ranges say by how much. They are no part of the evidence, as a
detector of another make finds another path; but values are told by both, or the new simulator has
links whose samples are right and whose ranges are a metre off.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.search import valued
from bench.discrepancy.joint.climb import ascended
from bench.discrepancy.joint.mixture import Found, Mixture, Values
from bench.discrepancy.joint.settings import RANGED_M, RANGED_WEIGHT
from bench.discrepancy.select.within_links import link_medians
from bench.discrepancy.settings import FIT_MEMBERS, MAD_TO_STD, SCORE_FIRST
from bench.errors import BenchError

Floats = NDArray[np.float64]
MEDIAN_STD = np.sqrt(np.pi / 2)  # of a median of normal values, over that of their mean


def by_ranges(found: Found, made: Ensemble) -> Found:
    """Return a strike whose values do for the ranges of struck links, too.

    `made` is what was simulated without it.
    """
    mixture, struck = found.mixture, found.struck
    recorded = link_medians(made.residual_of(RANGE)[None], mixture.given.code)[0][struck]
    bare = made.simulated_of(RANGE).mean(axis=0)
    known = recorded[np.isfinite(recorded)]
    if not len(known):
        return found

    def nats(values: Values) -> float:
        longer = _longer(mixture, values, bare)
        if longer is None:
            return 0.0
        those = longer[:, struck][:, np.isfinite(recorded)]
        return RANGED_WEIGHT * _likely(known, those[np.isfinite(those)])

    mixture.ranges = nats
    return ascended(found)


def _longer(mixture: Mixture, values: Values, bare: Floats) -> Floats | None:
    """Return by how much simulated links are longer where all are struck [m, L], in metres."""
    assert mixture.kind.strikes is not None
    effect = valued(mixture.kind, {**values, mixture.kind.strikes[0]: 1.0})
    given = mixture.given
    try:
        hit = given.comparison.ensemble(
            given.rows, (*mixture.beside, effect), FIT_MEMBERS, SCORE_FIRST
        )
    except BenchError:
        return None
    return link_medians(hit.simulated_of(RANGE) - bare, given.code)


def _likely(recorded: Floats, simulated: Floats) -> float:
    """Return the log likelihood of the difference between two medians, but for a constant."""
    if not len(simulated):
        return 0.0
    count = len(recorded)
    wide = [MAD_TO_STD * float(np.median(np.abs(x - np.median(x)))) for x in (recorded, simulated)]
    error = RANGED_M**2 + MEDIAN_STD**2 * sum(one**2 for one in wide) / count
    return float(-((np.median(recorded) - np.median(simulated)) ** 2) / (2 * error))
