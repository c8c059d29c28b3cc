"""Effects that leave a mark of their own in recordings, such as the grid of rounded samples.

What bears its mark is there, whatever a score says of it: it is put in before the search, so that
nothing else has to stand for it, and it is named.
"""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added
from bench.discrepancy.select.refute import Checked, announced
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.settings import FIT_MEMBERS
from bench.physics.effect import Effect


def marked(search: Search, added: Added = ()) -> Added:
    """Return the effects whose mark recorded rows bear and simulated ones do not.

    Each in the form that scores best beside `added`, or in the one that is among these.
    """
    if not search.fit.waveform:
        return ()
    have = {effect.name: effect for effect in added}
    found = []
    for kind in search.kinds.values():
        forms = kind.by_mark(search.fit.frame)
        if forms and not _simulated(search, kind):
            found.append(have.get(kind.name) or _best(search, added, forms))
    return tuple(found)


def forms_of_marks(search: Search) -> list[tuple[Effect, ...]]:
    """Return the forms of every effect whose mark recorded rows bear and simulated ones do not."""
    able = (kind for kind in search.kinds.values() if not _simulated(search, kind))
    return [forms for forms in (kind.by_mark(search.fit.frame) for kind in able) if forms]


def _simulated(search: Search, kind: type[Effect]) -> bool:
    """Return whether the simulated side bears the mark as well."""
    other = search.comparison
    if isinstance(other, Resimulation):
        return any(effect.physics == kind.name for effect in other.simulator.effects)
    return isinstance(other, TableComparison) and kind.hinted(other.frame)


def _best(search: Search, added: Added, forms: tuple[Effect, ...]) -> Effect:
    """Return the form that scores best on the fit rows."""

    def score(form: Effect) -> float:
        made = search.comparison.ensemble(search.fit, (*added, form), FIT_MEMBERS)
        return gain_interval(plain, tally(made), search.seed).value

    plain = tally(search.comparison.ensemble(search.fit, added, FIT_MEMBERS))
    return max(forms, key=score)


def with_marks(search: Search, held: Checked) -> Checked:
    """Return what was checked with every effect that bears its mark in it, and a round for each."""
    for effect in marked(search, held.simulated):
        known = any(turn.added and turn.added.name == effect.name for turn in held.rounds)
        added = _including(held.added, effect)
        rounds = held.rounds if known else _announced(search, held, added, effect)
        doubts = tuple(doubt for doubt in held.doubts if doubt.effect.name != effect.name)
        whole = _including(held.whole, effect) if held.whole else ()
        held = replace(held, added=added, rounds=rounds, doubts=doubts, whole=whole)
    return held


def _including(added: Added, effect: Effect) -> Added:
    """Return the effects with this one, as it is where it is among them."""
    inside = any(one.name == effect.name for one in added)
    return added if inside else (*added, effect)


def idle(held: Checked) -> set[str]:
    """Return the names of effects that only their mark speaks for.

    They are stated, but not put into the simulator: they help no link they were not fitted on.
    """
    alone = [turn for turn in held.rounds if turn.added and turn.explanation and not turn.strike]
    gains = {t.added.name: t.explanation.contenders for t in alone if t.added and t.explanation}
    bare = {name for name, every in gains.items() if len(every) == 1}
    return {name for name in bare if not gains[name][0].gain.likely_above_zero}


def _announced(search: Search, held: Checked, added: Added, effect: Effect) -> tuple[Round, ...]:
    """Return the rounds with one before the last that adds an effect by its mark."""
    *earlier, last = held.rounds
    return (*earlier, announced(search, last, added, effect), last)
