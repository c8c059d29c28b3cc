"""Delays that are no constants: of a device, but of another size in every link.

A cable is as long in every link. A clock that is set right now and then is early or late by more in
some links than in others, and its mean over these passes for a delay. What links keep beside delays
is usually of their own - walls, places, multipath - and as large for devices with little delay. So
where links keep offsets, these are held against delays that each link has more or less of: where
that does better, the delays change from link to link, and nothing says that they are any. Links in
sight tell, where there are several: behind what stands in the way some are off by far more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.evidence import Weighed
from bench.discrepancy.sets.in_sight import telling
from bench.discrepancy.sets.settings import DEFORMED, LAW_SIZE, NAME_NATS
from bench.physics.effects.ranging.antenna_delay import AntennaDelay

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

CHANGING = "delays of another size in every link"
BENT = "what links make of delays"


def same_in_every_link(contest: Contest, causes: Set) -> Set:
    """Return the set with delays that change from link to link as a cause without a name."""
    name, evidence = AntennaDelay.name, contest.evidence
    if name not in causes:
        return causes
    made = evidence.of(causes)
    without = evidence.at([causes], 0.0)[0]
    offsets = made.nats - without.nats > NAME_NATS * contest.crowding
    if not offsets or not _changes(contest, causes, made):
        return causes
    blocks = {**evidence.blocks, CHANGING: evidence.blocks[name]}
    contest.evidence = evidence.with_blocks(blocks)
    contest.evidence.widest[CHANGING] = LAW_SIZE
    return (*but(causes, name), CHANGING)


def _changes(contest: Contest, causes: Set, made: Weighed) -> bool:
    """Return whether delays that differ by link do better than constants and offsets of links.

    By no less than another form of them would (see `DEFORMED`).
    """
    evidence = contest.evidence
    delays = evidence.response(made, AntennaDelay.name)
    by_link = delays[:, None] * (evidence.links[:, None] == np.arange(evidence.links.max() + 1))
    other = evidence.with_blocks({**{o: evidence.blocks[o] for o in causes}, BENT: (by_link,)})
    other.widest[BENT] = LAW_SIZE
    asked = telling(contest)
    plain, other = evidence.among(asked).of(causes), other.among(asked)
    bent = other.at([(*causes, BENT)], 0.0)[0]
    constant = evidence.columns[:, evidence.places[AntennaDelay.name]]
    # What no constant delays do of it: either block may say what both can.
    more = rest_of(other.response(bent, BENT)[asked], constant[asked])
    large = float((more**2).sum()) >= DEFORMED**2 * float((delays[asked] ** 2).sum())
    return large and bent.nats > plain.nats
