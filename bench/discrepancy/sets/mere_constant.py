"""A small constant of all ranges has no cause that they tell.

Antennas of a make are late by a nanosecond or so, and no two by the same: where all devices agree
and ranges are a few centimetres off, a cover, a film, a detector or a cable does that as well, and
so does a law of which rows show the mean alone. Nor does a drift or an error of the level without a
slope say more. Only where devices differ, or where it is more than all these make, is it a name's.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.compare.view import Added
from bench.discrepancy.sets.choice import MERE, Choice, Set, but
from bench.discrepancy.sets.rivals import with_constant
from bench.discrepancy.sets.settings import LAW_M, RIVAL_NATS, SMALL_CONSTANT_M
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.units import C_M_PER_NS

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def as_mere(choice: Choice, added: Added) -> tuple[Choice, Added]:
    """Return a choice and its effects without a common delay that came out as a small constant.

    A set speaks for about so much; fitted in the simulator beside the others it may be less.
    """
    small = {e for e in added if isinstance(e, AntennaDelay) and e.physics in choice.names}
    small = {e for e in small if abs(e.delay_ns) * C_M_PER_NS / 2 < SMALL_CONSTANT_M}
    if not small:
        return choice, added
    names, (gone,) = choice.names, {effect.physics for effect in small}
    shifts_m = {MERE if name == gone else name: m for name, m in choice.shifts_m.items()}
    others = (*choice.others, MERE)
    made = replace(choice, names=but(names, gone), others=others, shifts_m=shifts_m)
    return made, tuple(effect for effect in added if effect not in small)


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
