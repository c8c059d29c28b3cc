"""Crystals that rows do not tell from delays: of one reply time, and never in the other role."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.settings import RIVAL_NATS
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.temperature import TemperatureDrift

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

BOTH = (AntennaDelay.name, TemperatureDrift.name)


def as_delay_and_drift(contest: Contest, causes: Set) -> Set:
    """Return the set with a delay and a drift for crystals, where both do as well, neither alone.

    Of one reply time a crystal is a constant of its device, and what temperature does to all of
    them a drift: one name for the two of them is no simpler. Each has the crystals for a rival
    then, so that neither is said alone.
    """
    able = contest.library.issuperset(BOTH) and not {*BOTH} & {*causes}
    if ClockOffset.name not in causes or not able:
        return causes
    rest = but(causes, ClockOffset.name)
    both, least = (*rest, *BOTH), contest.nats(causes) - RIVAL_NATS
    if contest.nats(both) < least or any(contest.nats((*rest, one)) >= least for one in BOTH):
        return causes
    return both if all(contest.possible(both, one) for one in BOTH) else causes
