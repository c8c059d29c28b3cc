"""The best set of causes of which every name does only what physics allows.

Beside others a name may do more than alone: a scale takes off what a bias of the level then adds.
So a name that does too much in the best set is no reason to do without it: what it stood beside may
be what is not there. Both are asked, and the set of more worth is taken.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.discrepancy.sets.beside import without_constants
from bench.discrepancy.sets.choice import Set, but_not

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def best_possible(contest: Contest, able: Set) -> Set:
    """Return the best set of causes that are `able`, without names that do too much.

    Or with them and without what they stood beside.
    """
    instead: list[Set] = []
    while True:
        best = contest.best(able)
        wrong = _wrong(contest, best)
        if not wrong:
            return max((best, *instead), key=contest.worth)
        instead.append(_without_others(contest, able, best, wrong))
        if left := without_constants(contest, wrong):
            contest.have({**contest.evidence.blocks, **left})
        able = tuple(one for one in able if one not in wrong or one in left)


def _wrong(contest: Contest, causes: Set) -> Set:
    """Return the names of a set that do what physics forbids."""
    named = (one for one in causes if one in contest.kinds)
    return tuple(one for one in named if not contest.possible(causes, one))


def _without_others(contest: Contest, able: Set, best: Set, wrong: Set) -> Set:
    """Return the best possible set without what stood beside names that did too much there."""
    while others := but_not(best, wrong):
        able = but_not(able, others)
        best = contest.best(able)
        wrong = _wrong(contest, best)
        if not wrong:
            return best
    return ()
