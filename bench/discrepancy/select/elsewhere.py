"""Effects on levels beside others: they must be there, too, where the others do nothing.

A wall of the library takes another share of a level than a real one does. What that leaves looks
like any effect on levels, but only where the walls are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import (
    CONTROL_ROWS,
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
