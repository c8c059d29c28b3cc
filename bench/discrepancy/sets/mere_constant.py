"""A small constant of all ranges has no cause that they tell.

Antennas of a make are late by a nanosecond or so, and no two by the same: where all devices agree
and ranges are a few centimetres off, a cover, a film, a detector or a cable does that as well, and
so does a law of which rows show the mean alone. Nor does a drift or an error of the level without a
slope say more. Only where devices differ, or where it is more than all these make, is it a name's.
Beside what goes up and down by more it is the mean of that: a reflection pulls whatever a receiver
finds, and an antenna that is late in some directions alone is late in the mean over all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.choice import MERE, Choice, Set, but
from bench.discrepancy.sets.rivals import with_constant
from bench.discrepancy.sets.settings import FLAT_M, LAW_M, OFF_BY, RIVAL_NATS, SMALL_CONSTANT_M
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.units import Floats

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

WITH_A_MEAN = (AntennaPattern.name, GroundBounce.name)  # go up and down, and pull


def swing_m(shifts_m: Mapping[str, Floats]) -> float:
    """Return by how much ranges go up and down, at most, by what has a mean of its own (metres).

    Of shifts [n] by cause, to a share that forms are off by; 0 where none has one. A pattern that
    is right in one direction is late by as much in the mean as it goes up and down.
    """
    swings = (float(np.ptp(m)) / 2 for one, m in shifts_m.items() if one in WITH_A_MEAN)
    return (1 + OFF_BY) * max(swings, default=0.0)


def as_mere(choice: Choice, fitted_m: Mapping[str, Floats]) -> Choice:
    """Return a choice without names that came out as a small constant, which has no name.

    A set speaks for about so much; fitted in the simulator beside the others, where a name moves
    ranges by `fitted_m` [n], it may be less. What a set had as no constant does not hold, and
    nothing is said of it.
    """
    small = {name for name, shift_m in fitted_m.items() if _is_mere(shift_m)}
    if not small:
        return choice
    names = tuple(name for name in choice.names if name not in small)
    shifts_m = {name: m for name, m in choice.shifts_m.items() if name not in small}
    taken = [m for name, m in choice.shifts_m.items() if name in small]
    flat = [m for m in taken if np.ptp(m) <= abs(np.mean(m))]
    if taken and not flat:
        return replace(choice, names=names, shifts_m=shifts_m)
    shifts_m |= {MERE: np.sum(flat, axis=0)} if flat else {}
    return replace(choice, names=names, others=(*choice.others, MERE), shifts_m=shifts_m)


def _is_mere(shift_m: Floats) -> bool:
    """Return whether shifts [n] of ranges are one small constant, and not nothing."""
    known = shift_m[np.isfinite(shift_m)]
    if not len(known):
        return False
    low, high = float(known.min()), float(known.max())
    return high - low < FLAT_M and 0 < abs(low + high) / 2 < SMALL_CONSTANT_M


def without_mere_constants(contest: Contest, causes: Set) -> Set:
    """Return the set in which a name that brings no more than a small constant is that, unnamed."""
    for name in [one for one in causes if one in contest.library]:
        rest, evidence = but(causes, name), contest.evidence
        least = evidence.of(causes).nats - RIVAL_NATS * contest.crowding
        nats, constant_m = with_constant(contest, evidence, rest)
        if nats > least and abs(constant_m) < max(SMALL_CONSTANT_M, swing_m(contest.shifts(rest))):
            column = contest.seen(np.full((len(contest.known), 1), LAW_M))
            contest.evidence = evidence.with_blocks({**evidence.blocks, MERE: (column,)})
            return (*rest, MERE)
    return causes
