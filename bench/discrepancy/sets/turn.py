"""The turn of a search in which all causes that act on ranges are named together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.ensemble import NothingSharedError
from bench.discrepancy.compare.view import Added
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.state import Round, Search, State
from bench.discrepancy.sets.choice import Choice
from bench.discrepancy.sets.choose import chosen, decided, judged_by_sets
from bench.discrepancy.sets.install import installed
from bench.discrepancy.sets.settings import SCATTER_NATS
from bench.discrepancy.sets.struck_instead import struck_instead
from bench.discrepancy.settings import SCATTER_MARGIN_NATS, SCORE_FIRST, SCORE_MEMBERS
from bench.errors import BenchError

Turns = tuple[Round, ...]
NEITHER: tuple[Added, Turns, Round | None] = (), (), None


def agreed(state: State, located: Located, journal: Journal) -> tuple[State, bool]:
    """Return the state with the set of causes that ranges speak for, and whether that is news."""
    names = judged_by_sets(state.search)
    beside = tuple(effect for effect in state.added if effect.physics not in names)
    if not names or decided(state.search, beside):
        return state, False
    state = _working(state, names)
    search = state.search
    search.progress("weighing sets of causes")
    found = state.guard.safely("sets of causes", journal.kept(chosen), Choice())(search, beside)
    number = search.work.number if search.work else -1  # of this process: not to be kept
    state = replace(state, search=replace(search, choice=replace(found, view=number)))
    if set(found.names) == {effect.physics for effect in state.added} & names:
        return state, False
    return _installed(state, beside, located, journal)


def _working(state: State, names: frozenset[str]) -> State:
    """Return the state without effects that fail as they are, which are noted."""
    failed = _failing(state.search, names)
    kinds = {n: k for n, k in state.search.kinds.items() if k.name not in failed}
    search = replace(state.search, kinds=kinds)
    return replace(state, search=search, skipped={**state.skipped, **failed})


def _failing(search: Search, names: frozenset[str]) -> Mapping[str, str]:
    """Return the names of effects that cannot be simulated, and why."""
    failed = {}
    for name in names & set(search.kinds):
        effect = search.kinds[name]()
        try:
            search.comparison.ensemble(search.discover, (effect,), SCORE_MEMBERS, SCORE_FIRST)
        except NothingSharedError:
            failed[name] = f"effect {name!r} gives values that are not finite"
        except BenchError as problem:
            failed[name] = str(problem)
    return failed


def _installed(
    state: State, beside: Added, located: Located, journal: Journal
) -> tuple[State, bool]:
    """Return the state with the effects of the choice in place, each with a round of its own."""
    search = state.search
    step = state.guard.safely("fitting a set of causes", journal.kept(_fitted), NEITHER)
    added, turns, struck = step(search, beside, located)
    if struck and struck.strike:
        spared = search.spared(struck.strike)
        return replace(state.after(struck), search=spared, added=beside), True
    if not turns:
        return replace(state, search=replace(search, choice=_nameless(search)), added=beside), False
    have = {turn.added.physics for turn in turns if turn.added}
    old = tuple(t for t in state.rounds if not (t.added and t.added.physics in have))
    return replace(state, added=added, rounds=(*old, *turns)), True


def _fitted(search: Search, beside: Added, located: Located) -> tuple[Added, Turns, Round | None]:
    """Return the effects of the choice, their rounds, and a round with links struck instead."""
    added, turns = installed(search, beside, located)
    return added, turns, struck_instead(search, beside, added, turns[0]) if turns else None


def _nameless(search: Search) -> Choice:
    """Return the choice of a search without its names."""
    return replace(search.choice, names=())


def left_to_name(search: Search, explanation: Explanation) -> Explanation:
    """Return the explanation with only those contenders that sets do not decide about.

    Where a law or a fault is there, what it leaves is no scatter.
    """
    names = judged_by_sets(search)
    able = tuple(c for c in explanation.contenders if c.name not in names)
    if search.choice.scattering:
        able = tuple(c for c in able if not type(c.effect).independent)
    return replace(explanation, contenders=able)


def least_scatter(search: Search) -> float:
    """Return the nats that independent scatter must gain."""
    return SCATTER_NATS if search.choice.view >= 0 else SCATTER_MARGIN_NATS


def unjudged(search: Search) -> Search:
    """Return a search that offers only effects that sets do not decide about."""
    names = judged_by_sets(search)
    return replace(search, kinds={n: k for n, k in search.kinds.items() if n not in names})
