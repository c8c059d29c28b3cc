"""The round in which nothing stands out any more, or nothing explains what does."""

from __future__ import annotations

from dataclasses import replace

from bench.checkpoint.journal import Journal
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.marks import seen_first
from bench.discrepancy.select.scatter_alone import scatter_alone, scatter_beside
from bench.discrepancy.select.second_level import calmed
from bench.discrepancy.select.state import Round, State
from bench.discrepancy.select.stepwise import struck_round
from bench.discrepancy.sets import turn as sets
from bench.discrepancy.sets.settings import SEEN_NATS
from bench.discrepancy.sets.sure import beyond_doubt


def last_round(state: State, located: Located, journal: Journal) -> State:
    """Return the finished state where nothing stands out any more, but for scatter of rows.

    Where nothing did before either, sets of causes are asked: ranges may speak for a shape that no
    interval has. And what scatters may be any cause by which rows of a link differ: then marks are
    looked for first, and there is another round where one is found. Scatter is asked beside it
    then: what rounds ranges scatters by itself. Scatter is named alone where it is as much beyond
    doubt as any other name must be.
    """
    asked, news = (state, False) if state.added else sets.agreed(state, located, journal)
    if news and beyond_doubt(asked.search.choice):
        return asked
    beside = state.guard.safely("scatter beside", journal.kept(scatter_beside), None)
    last = beside(state.search, state.added, located)
    if last and not state.added:
        marked = state.guard.safely("marks", seen_first, state)(state, located)
        if marked is not state:
            return marked
        if news:
            return asked
        sure = not asked.search.choice.scattering and _beyond_doubt(last)
        state, last = asked, last if sure else None
    return state.after(last or Round(located, None, None), finished=True)


def _beyond_doubt(turn: Round) -> bool:
    """Return whether scatter brings as much as a name must where no search found anything."""
    return turn.strike is not None and turn.strike.evidence.value >= SEEN_NATS


def unexplained(
    state: State, located: Located, explanation: Explanation, turn: int, journal: Journal
) -> State:
    """Return the state after a round in which no effect gains enough: mostly the finished one.

    What stands out may be no more than other forms of the causes do to levels, or scatter alone.
    Beside causes that are named, scatter of rows is asked in any case.
    """
    kept, safely = journal.kept, state.guard.safely
    search, added = state.search, state.added
    located = safely("levels left", kept(calmed), located)(search, added, located, turn)
    if not located.significant:
        return last_round(state, located, journal)
    alone = safely("scatter alone", kept(scatter_alone), None)
    found = alone(search, added, explanation, located)
    if found:
        return state.after(struck_round(located, explanation, found), finished=True)
    beside = safely("scatter beside", kept(scatter_beside), None)
    scatter = beside(search, added, located) if added else None
    if scatter:
        state, located = state.after(scatter), _but_scatter(located)
    return state.after(Round(located, explanation, None), finished=True)


def _but_scatter(located: Located) -> Located:
    """Return what stands out without how far ranges lie from their link."""
    scattered = {(RANGE, "spread"), (RANGE, "rows")}
    rest = [f for f in located.findings if (f.cell.observable, f.cell.moment) not in scattered]
    return replace(located, findings=tuple(rest))
