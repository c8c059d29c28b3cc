"""The round in which nothing stands out any more, among thousands of places that were searched."""

from __future__ import annotations

from bench.checkpoint.journal import Journal
from bench.discrepancy.locate.permutation_test import Located
from bench.discrepancy.select.marks import seen_first
from bench.discrepancy.select.scatter_alone import scatter_beside
from bench.discrepancy.select.state import Round, State
from bench.discrepancy.sets import turn as sets


def last_round(state: State, located: Located, journal: Journal) -> State:
    """Return the finished state where nothing stands out any more, but for scatter of rows.

    Where nothing did before either, what scatters may be any cause by which rows of a link differ:
    then marks are looked for and sets of causes are asked first, and there is another round where
    one is found. Scatter is asked beside it then: what rounds ranges scatters by itself.
    """
    beside = state.guard.safely("scatter beside", journal.kept(scatter_beside), None)
    last = beside(state.search, state.added, located)
    if last and not state.added:
        marked = state.guard.safely("marks", seen_first, state)(state, located)
        if marked is not state:
            return marked
        state, news = sets.agreed(state, located, journal)
        if news:
            return state
        last = None if state.search.choice.others else last
    return state.after(last or Round(located, None, None), finished=True)
