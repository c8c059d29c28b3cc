"""Names that could stand in the place of a name of a set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.own_weights import Beside, own_nats
from bench.discrepancy.sets.settings import NEAR_NATS, RIVAL_NATS
from bench.physics.effects.ranging.antenna_delay import COMMON_M, AntennaDelay

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest
    from bench.discrepancy.sets.evidence import Evidence

CONSTANT = "a constant"


def rivals(contest: Contest, causes: Set, name: str) -> Set:
    """Return the names that could stand in the place of one.

    Those of as much evidence, and those of which one value does the same to every row: freedom
    that a name does not need here is nothing against it.
    """
    rest = but(causes, name)
    others = tuple(sorted((contest.library | contest.untold) - set(causes)))
    same = _same_rows(contest, causes, name, others)
    beside = Beside(contest, causes)
    near = {o for o in others if _near(beside, (*rest, o))}
    able = [o for o in others if o in same or o in near]
    return tuple(o for o in able if o in same or contest.possible((*rest, o), o))


def _near(beside: Beside, other: Set) -> bool:
    """Return whether a set is not excluded beside another, at weights of its own where near."""
    behind = beside.contest.worth(beside.causes) - beside.contest.worth(other)
    return behind < RIVAL_NATS or (behind < NEAR_NATS and beside.lead(other) > -RIVAL_NATS)


def _same_rows(contest: Contest, causes: Set, name: str, others: Set) -> Set:
    """Return of which others one value does to every row what a name does, within scatter."""
    made = contest.evidence.of(causes)
    target = contest.evidence.toward(contest.evidence.response(made, name))
    return tuple(
        one
        for one, (nats, shift_m) in ((o, target.nearest(o, made)) for o in others)
        if nats / contest.crowding < RIVAL_NATS
        and contest.kinds[one].possible(contest.rows.scene, contest.spread(shift_m))
    )


def beside_a_constant(contest: Contest, causes: Set, name: str) -> dict[str, float]:
    """Return the names that do as well as an error of the level, each with its constant in metres.

    Levels follow the distance. A curve over them has a constant of its own, and so has a scale of
    devices that were calibrated at some distance. What tells the two apart are levels that depart
    from what is usual there, but not those of obstructed paths, which are weaker and longer by
    themselves. None for other names, nor where antenna delays take part, which are constants.
    """
    kind = contest.kinds[name]
    if not kind.follows or AntennaDelay.name in causes or AntennaDelay.name not in contest.library:
        return {}
    clear, rest = clear_levels(contest), but(causes, name)
    evidence = contest.evidence.among(clear)
    least, near = (evidence.of(causes).nats - n * contest.crowding for n in (RIVAL_NATS, NEAR_NATS))
    out = {}
    for one in sorted(contest.library - set(causes)):
        nats, constant_m = with_constant(contest, evidence, (*rest, one))
        able = nats > least or (nats > near and _own_constant(contest, causes, (*rest, one), clear))
        if able and contest.possible((*rest, one), one):
            out[one] = constant_m
    return out


def _own_constant(contest: Contest, causes: Set, others: Set, rows: NDArray[np.bool_]) -> bool:
    """Return whether other causes and a constant are not excluded, at weights of their own."""
    more = beside_constant(contest, contest.evidence, others)
    behind = own_nats(contest.evidence, causes, rows) - own_nats(more, (*others, CONSTANT), rows)
    return behind < RIVAL_NATS * contest.crowding


def clear_levels(contest: Contest) -> NDArray[np.bool_]:
    """Return the rows whose levels are usual, and hardly those of obstructed paths.

    Where links keep large offsets something stands in the way of some: weaker signals are then
    longer by themselves, if only by little, and only stronger ones tell what follows a level.
    """
    if contest.evidence.mean_ratio <= 0:
        return contest.usual
    return np.asarray(contest.usual & (contest.fading >= 0))


def delays_and_more(contest: Contest, causes: Set, others: Set) -> dict[str, float]:
    """Return rivals of antenna delays that stand beside a constant, each with it in metres.

    Delays of devices have a mean, which what sums to nothing over devices has to stretch for. A
    constant is expected of radios that nobody calibrated: it stands unless it is all that there is,
    or excluded.
    """
    if AntennaDelay.name not in causes:
        return {}
    rest, least = but(causes, AntennaDelay.name), RIVAL_NATS * contest.crowding
    plain = with_constant(contest, contest.evidence, rest)[0]
    out = {}
    for one in sorted(set(others) & contest.library):
        nats, constant_m = with_constant(contest, contest.evidence, (*rest, one))
        if nats - least > plain and nats + least > contest.evidence.of((*rest, one)).nats:
            out[one] = constant_m
    return out


def with_constant(contest: Contest, evidence: Evidence, causes: Set) -> tuple[float, float]:
    """Return the log evidence of a set beside a constant, and that constant in metres."""
    made = beside_constant(contest, evidence, causes).of((*causes, CONSTANT))
    return made.nats, float(COMMON_M * made.factors[-1])


def beside_constant(contest: Contest, evidence: Evidence, causes: Set) -> Evidence:
    """Return the evidence of some causes and a constant."""
    column = contest.seen(np.full((len(contest.known), 1), COMMON_M))
    blocks = {one: evidence.blocks[one] for one in causes}
    return evidence.with_blocks({**blocks, CONSTANT: (column,)})
