"""A small constant of all ranges has no cause that they tell.

Antennas of a make are late by a nanosecond or so, and no two by the same: where all devices agree
and ranges are a few centimetres off, a cover, a film, a detector or a cable does that as well, and
so does a law of which rows show the mean alone. Nor does a drift or an error of the level without a
slope say more. Only where devices differ, or where it is more than all these make, is it a name's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.choice import MERE, Set, but
from bench.discrepancy.sets.rivals import with_constant
from bench.discrepancy.sets.settings import LAW_M, RIVAL_NATS, SMALL_CONSTANT_M

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def without_mere_constants(contest: Contest, causes: Set) -> Set:
    """Return the set in which a name that brings no more than a small constant is that, unnamed."""
    for name in [one for one in causes if one in contest.library]:
        rest, evidence = but(causes, name), contest.evidence
        least = evidence.of(causes).nats - RIVAL_NATS * contest.crowding
        nats, constant_m = with_constant(contest, evidence, rest)
        if nats > least and abs(constant_m) < SMALL_CONSTANT_M:
            column = contest.seen(np.full((len(contest.known), 1), LAW_M))
            contest.evidence = evidence.with_blocks({**evidence.blocks, MERE: (column,)})
            return (*rest, MERE)
    return causes
