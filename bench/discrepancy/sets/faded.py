"""An error of the level against what fades: it follows all that moves a level, the distance too.

Where ranges go with what levels are off the simulated ones alone, and not with what the distance
makes of them, no level is at work: two rays meet, or something stands in the way, and both move.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.law.settings import LAW_SAME_PLACE_M
from bench.discrepancy.sets.beside import nats_with
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.formed import Beaten, Formed
from bench.discrepancy.sets.settings import (
    FADING_SHARE,
    FEWEST_ROWS,
    FORM_NATS,
    LAW_M,
    LAW_NATS,
    NAME_NATS,
    TIED_NATS,
    USUAL_SCATTERS,
)
from bench.physics.ways import spread_over

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]
NAME = "a law of how much stronger signals are than simulated"


def fading_db(rows: View, made: Ensemble) -> Floats:
    """Return how much stronger signals are than simulated [n], 0 everywhere where nothing fades.

    Another path loss and a control of levels make curves over the distance and the simulated level:
    where these are most of it, it is no fading.
    """
    nothing = np.zeros(len(rows.rows))
    if LEVEL not in made.names:
        return nothing
    simulated = made.simulated_of(LEVEL).mean(axis=0)
    stronger = numeric(rows.frame, LEVEL) - simulated
    far = np.log10(np.maximum(rows.scene.true_range_m, LAW_SAME_PLACE_M))
    known = np.isfinite(stronger) & np.isfinite(far)
    if known.sum() < FEWEST_ROWS:
        return nothing
    out = stronger[known] - np.median(stronger[known])
    curve = np.stack([far**0, far, far**2, simulated, simulated**2], axis=1)[known]
    off = rest_of(out, curve)
    if float(off.var()) < FADING_SHARE * float(out.var()):
        return nothing
    most = USUAL_SCATTERS * float(np.std(out))
    nothing[known] = np.clip(out, -most, most)
    return nothing


def faded(contest: Contest, best: Set) -> Beaten | None:
    """Return the name of a set that follows the level, where what fades alone leads it."""
    law = _law(contest.fading)
    if law is None:
        return None
    for one in [c for c in best if c in contest.library and contest.kinds[c].follows == LEVEL]:
        lead = _lead(contest, best, one, law)
        if lead is not None:
            return Beaten((one,), law, lead)
    return None


def _lead(contest: Contest, best: Set, one: str, law: Formed) -> float | None:
    """Return by how much a law in the place of an error of the level leads; None if too little.

    Beside the rest of it, or all but one. What the distance makes of levels, and ranges do not
    follow, takes another cause to undo: where that does nothing else, for beside what is left the
    law leads the error, the law alone need only do about as well as both.
    """
    rest, worth = but(best, one), contest.worth(best)
    beside = _worth(contest, rest, law)
    less = [(_worth(contest, but(rest, other), law), but(best, other)) for other in rest]
    most = max((beside, *(nats for nats, _ in less))) - worth
    undone = [nats for nats, left in less if nats - contest.worth(left) > FORM_NATS]
    alone = max(undone, default=-np.inf) - worth
    return max(most, alone) if most > FORM_NATS or alone > TIED_NATS else None


def _worth(contest: Contest, rest: Set, law: Formed) -> float:
    """Return the worth of a law beside some causes."""
    nats = nats_with(contest, rest, {law.name: law.parts}) - law.pays - NAME_NATS
    return nats - sum(map(contest.price, rest))


def _law(fading: Floats) -> Formed | None:
    """Return smooth curves over what fades, in known rows [n]; None where nothing does."""
    if not np.ptp(fading) > 0:
        return None
    parts = np.full((len(fading), 1), LAW_M), LAW_M * spread_over(fading)
    return Formed(NAME, parts, LAW_NATS - NAME_NATS, frozenset({LEVEL}), True, np.ones((1, 1)))
