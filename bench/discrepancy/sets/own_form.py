"""What a name owes to a form of its own: beside what only looks like it, and others deformed.

A set divides what several causes can do by their usual sizes alone: the mean pull of a reflection
and a scale are both smooth over the distance. So neither what a name is given of that, nor that
another could do all of it, tells much; what physics then makes of the other does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.beside import nats_with
from bench.discrepancy.sets.blocks import deformed, off_by
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.settings import DEFORMED, LAW_M

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

LOOKS_ALIKE = "what only looks like it"


def allowed(contest: Contest, causes: Set, name: str) -> bool:
    """Return whether physics allows what a name does to the ranges in a set."""
    return contest.kinds[name].possible(contest.rows.scene, contest.shifts(causes)[name])


def told_by_form(contest: Contest, causes: Set, name: str) -> bool:
    """Return whether a name of a set is worth its price beside all that only looks like it."""
    columns = contest.kinds[name].told_beyond(contest.rows.scene)
    if columns is None:
        return False
    alike = {LOOKS_ALIKE: (contest.seen(LAW_M * columns[contest.known]),)}
    lead = nats_with(contest, causes, alike) - nats_with(contest, but(causes, name), alike)
    return lead >= contest.price(name)


def others_may(contest: Contest, causes: Set, name: str) -> bool:
    """Return whether physics allows what other names of a set take over where one is left out.

    Of what is no small part of what they do: a reflection that does a scale's part no longer goes
    up and down, a bias of the level that does a lag's is too large.
    """
    rest = but(causes, name)
    before, after = contest.shifts(causes), contest.shifts(rest)
    return all(
        np.std(after[one] - before[one]) < DEFORMED * np.std(after[one])
        or allowed(contest, rest, one)
        for one in rest
        if one in contest.kinds
    )


def beyond_others(contest: Contest, causes: Set, name: str) -> float:
    """Return the evidence in nats that a name brings where the others may be deformed."""
    rest, rows, some = but(causes, name), contest.rows, contest.known
    shifts = [(o, m, contest.kinds.get(o)) for o, m in contest.shifts(rest).items()]
    seen = contest.seen
    bent = {f"{o}, deformed": (seen(deformed(m, rows, of)[some]),) for o, m, of in shifts}
    off = {f"{o}, off": (seen(off_by(m, rows, of)[some]),) for o, m, of in shifts}
    other = contest.evidence.with_blocks(contest.evidence.blocks | bent | off)
    other.widest |= dict.fromkeys(off, 1.0)  # no more than a share of what a cause does
    with_it, without_it = (other.of((*one, *bent, *off)).nats for one in (causes, rest))
    return (with_it - without_it) / contest.crowding
