"""Effects on levels beside others: they must be there, too, where the others do nothing.

A wall of the library takes another share of a level than a real one does. What that leaves looks
like any effect on levels, but only where the walls are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import Added, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import (
    CONTROL_ROWS,
    FORMS_OF_MARK,
    LEAST_SCATTER_M,
    SCORE_FIRST,
    SCORE_MEMBERS,
)
from bench.physics.base import Base


def elsewhere_too(search: Search, added: Added, explanation: Explanation) -> Explanation:
    """Return the explanation without effects on levels that only act where `added` do.

    Of ranges without waveforms; where enough rows are left in which one of `added` does nothing.
    """
    if search.work is None or not added:
        return explanation
    able = tuple(c for c in explanation.contenders if _stands(search, added, c))
    able = tuple(c for c in able if _beyond_marks(search, added, c))
    return replace(explanation, contenders=able)


def _stands(search: Search, added: Added, contender: Contender) -> bool:
    """Return whether a contender gains where others do nothing; one that moves ranges is kept."""
    for view in without_others(search.searched, added):
        before, after = (
            search.comparison.ensemble(view, some, SCORE_MEMBERS, SCORE_FIRST)
            for some in (added, (*added, contender.effect))
        )
        if moves_ranges(after, before):
            return True
        if not gain_interval(tally(before), tally(after), search.seed).likely_above_zero:
            return False
    return True


def _beyond_marks(search: Search, added: Added, contender: Contender) -> bool:
    """Return whether scatter beside what bears a mark does more than another form of that would.

    Ranges that are rounded by chance, or twice, scatter more than such to the nearest step do.
    """
    marks = [effect for effect in added if type(effect).marked]
    if not marks or not type(contender.effect).independent:
        return True
    sizes = []
    for effect, rest in [(contender.effect, added), *((e, without(added, e)) for e in marks)]:
        with_it, bare = (
            search.comparison.ensemble(search.searched, some, SCORE_MEMBERS, SCORE_FIRST)
            for some in ((*rest, effect), rest)
        )
        change = with_it.simulated_of(RANGE) - bare.simulated_of(RANGE)
        sizes.append(float(np.nanstd(change)))
    return sizes[0] > FORMS_OF_MARK * max(sizes[1:])


def without_others(rows: View, added: Added) -> list[View]:
    """Return the links in which each effect must do nothing, where these are enough."""
    out = []
    for effect in added:
        inert = effect.inert(Base().paths(rows.scene))
        rest = rows.leaving(np.unique(rows.links[~inert]))
        if len(rest.rows) >= CONTROL_ROWS and len(rest.rows) < len(rows.rows):
            out.append(rest)
    return out


def moves_ranges(whole: Ensemble, rest: Ensemble) -> bool:
    """Return whether ranges of `whole` differ from those of `rest`, of the same replicates."""
    if RANGE not in whole.names or RANGE not in rest.names:
        return False
    change = whole.simulated_of(RANGE) - rest.simulated_of(RANGE)
    return bool(np.nanmax(np.abs(change), initial=0.0) > LEAST_SCATTER_M)
