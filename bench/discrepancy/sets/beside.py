"""Sets with more blocks beside them: how probable these make the recorded ranges."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.law.between import constants_of_devices, over_places, own_of_devices
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.evidence import Columns, Evidence, Weighed
from bench.discrepancy.sets.set_up import PLACE, PLAN, is_fault
from bench.discrepancy.sets.settings import (
    CONSTANT_M,
    LAW_M,
    LAW_NATS,
    LAW_SIZE,
    LEAST_WEIGHT,
    RIVAL_NATS,
    TIED_NATS,
)
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]
ENDS = ("tx", "rx")
DELAY_OR_CLOCK = (AntennaDelay.name, ClockOffset.name)
OWN_DELAYS = "a delay of every device"


def told_law(contest: Contest, law: str, names: Set) -> bool:
    """Return whether a smooth law, if it is about places, is told from delays of devices.

    Alone or beside some names: what else is there may hide it, or do it.
    """
    if not over_places((law,)):
        return True
    parts = contest.evidence.blocks[law]
    return any(told_from_delays(contest, rest, parts, LAW_NATS) for rest in ((), names))


def told_from_delays(
    contest: Contest,
    rest: Set,
    parts: tuple[Floats, ...],
    price: float,
    times: Floats | None = None,
) -> bool:
    """Return whether a law about places is worth its price in nats beside delays of devices.

    Of its `parts` [n, k] only what varies within devices counts: what differs between them alone
    may be their delays. Of a law that goes with something else, `times` [n, k], it may be what they
    have of their own in proportion to that: a clock's offset, times the reply time. True where
    devices are not known.
    """
    frame = contest.rows.frame.iloc[contest.known]
    devices = {end: frame[end].astype(str).to_numpy(object) for end in ENDS if end in frame}
    if not devices:
        return True
    delays = {OWN_DELAYS: own_of_devices(LAW_M * constants_of_devices(devices), times)}
    own = np.hstack(delays[OWN_DELAYS])
    within = tuple(rest_of(part, own) for part in parts)
    lead = nats_with(contest, rest, {**delays, "within": within}) - nats_with(contest, rest, delays)
    return lead >= price


def without_constants(contest: Contest, names: Collection[str]) -> dict[str, tuple[Floats, ...]]:
    """Return the parts of what clocks can do but for their constants, of those that have one.

    Where what one does in the mean is beyond physics, the mean is an antenna delay's: a delay of
    0.15 m would else forbid the drift of 2 mm per degree beside it. None where no delay takes part.
    """
    blocks, out = contest.evidence.blocks, {}
    for one in (o for o in names if contest.kinds[o].everywhere):
        left = tuple(part[:, varies(part)] for part in blocks[one])
        columns, kept = (sum(part.shape[1] for part in some) for some in (blocks[one], left))
        if columns > kept > 0 and AntennaDelay.name in contest.library:
            out[one] = left
    return out


def varies(columns: Floats) -> NDArray[np.bool_]:
    """Return which columns [n, k] are not of one value alone."""
    return np.asarray(np.ptp(columns, axis=0) > CONSTANT_M, np.bool_)


def misplaced(contest: Contest, causes: Set) -> Set:
    """Return the set with devices that stand elsewhere instead of a name they do as well as.

    A plan that is stretched moves all: where rows do not tell, no name is sure (see `TIED_NATS`). A
    receiver that hangs too low is late by nearly the same everywhere, as by its own delay or clock,
    one number where a place is three: what has no lead of that is said beside it (`elsewhere`).
    """
    places = [one for one in contest.evidence.blocks if one.startswith((PLACE, PLAN))]
    for name in [one for one in causes if one in contest.library]:
        rest = but(causes, name)
        lead = {one: contest.nats((*rest, one)) for one in places if one not in causes}
        best = max(lead, key=lambda one: lead[one], default=None)
        if best is None:
            continue
        more = name in DELAY_OR_CLOCK or best.startswith(PLAN)
        if lead[best] > contest.nats(causes) + (RIVAL_NATS if more else TIED_NATS):
            causes = (*rest, best)
    return causes


def elsewhere(contest: Contest, causes: Set) -> Set:
    """Return the devices of which a place does about as well as the delays or clocks of a set."""
    name = next((one for one in causes if one in DELAY_OR_CLOCK), None)
    if name is None:
        return ()
    rest = but(causes, name)
    places = [o for o in contest.evidence.blocks if o.startswith(PLACE) and o not in causes]
    least = contest.nats(causes) + TIED_NATS
    able = (one for one in places if contest.nats((*rest, one)) > least)
    return tuple(one.removeprefix(PLACE) for one in able)


def leading_faults(contest: Contest, causes: Set) -> Set:
    """Return the faults of the set-up in a set that bring more than any name beside them."""
    brings = {one: contest.brings(causes, one) for one in causes}
    most = max((nats for one, nats in brings.items() if one in contest.library), default=0.0)
    return tuple(one for one, nats in brings.items() if is_fault(one) and nats > most)


def nats_with(contest: Contest, rest: Set, more: Columns) -> float:
    """Return the log evidence of a set with more blocks."""
    return weighed_with(contest, rest, more).nats / contest.crowding


def weighed_with(contest: Contest, rest: Set, more: Columns) -> Weighed:
    """Return a set with more blocks, as large as laws may be."""
    return _with_more(contest, rest, more).of((*rest, *more))


def reweighed(contest: Contest, rest: Set, more: Columns) -> tuple[Weighed, Floats]:
    """Return a set with more blocks, every row weighed by what these leave of it.

    And what they leave of the rows that take part, in metres.
    """
    other = _with_more(contest, rest, more)
    other.reweigh((*rest, *more))
    made = other.of((*rest, *more))
    left = other.left_m - other.columns[:, made.places] @ made.factors
    return made, np.asarray(left[other.weights > LEAST_WEIGHT])


def _with_more(contest: Contest, rest: Set, more: Columns) -> Evidence:
    blocks = {one: contest.evidence.blocks[one] for one in rest}
    other = contest.evidence.with_blocks({**blocks, **more})
    other.widest = {**contest.evidence.widest, **dict.fromkeys(more, LAW_SIZE)}
    return other
