"""A curve over the distance that is nearly a line is a scale, with a form of its own beside.

Tapes sag and sticks are laid end to end, so what is a scale to the eye goes up in steps and bends:
a free curve follows these and wins over a line. What it is off a line is then another form of the
scale, as long as it is no more than a line may be off beside any other cause.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.blocks import OF_RANGE
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.settings import OFF_BY
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import RangeScale

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def as_scale(contest: Contest, causes: Set) -> Set:
    """Return the set with a scale, and a delay where it is worth one, for a nearly straight law.

    As it is where the law of the distance bends, or no physics allows what these would do.
    """
    able = RangeScale.name in contest.library - set(causes)
    if OF_RANGE not in causes or not able or _off_a_line(contest, causes) > OFF_BY:
        return causes
    scale = (*but(causes, OF_RANGE), RangeScale.name)
    some = [scale]
    if AntennaDelay.name in contest.library - set(causes):
        some.append((*scale, AntennaDelay.name))
    best = max(some, key=contest.worth)
    return best if all(contest.possible(best, o) for o in best if o in contest.kinds) else causes


def _off_a_line(contest: Contest, causes: Set) -> float:
    """Return what share of its scatter over rows a law of the distance is off a line."""
    law = contest.shifts(causes)[OF_RANGE][contest.known]
    far_m, weights = contest.rows.scene.true_range_m[contest.known], contest.evidence.weights
    off = law - np.polynomial.Polynomial.fit(far_m, law, 1, w=np.sqrt(weights))(far_m)
    middle = float(np.average(law, weights=weights))
    squares = [float(np.average(one**2, weights=weights)) for one in (off, law - middle)]
    return float(np.sqrt(squares[0] / max(squares[1], 1e-24)))
