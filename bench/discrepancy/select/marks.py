"""Effects that leave a mark of their own in recordings, such as the grid of rounded samples.

What bears its mark is there, whatever a score says of it: it is put in before the search, so that
nothing else has to stand for it, and it is named.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.per_device import fits_itself, with_values
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import regressed
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.logged import shown
from bench.discrepancy.select.refute import Checked, announced
from bench.discrepancy.select.settings import FORM_LEAD_NATS, MARK_SHARE, ODD_MARK_SHARE, PRINTED
from bench.discrepancy.select.state import Round, Search, State
from bench.discrepancy.sets.choose import worth_beside
from bench.discrepancy.settings import FIT_MEMBERS, MAD_TO_STD, RESIDUAL_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.ranging.range_rounding import RangeRounding


def marked(search: Search, added: Added = ()) -> Added:
    """Return the effects whose mark recorded rows bear and simulated ones do not.

    Each in the form that scores best beside `added`, or in the one that is among these.
    """
    if not search.fit.waveform:
        return (*grids(search, added), *shown(search, added))
    have = {effect.name: effect for effect in added}
    found = []
    for kind in search.kinds.values():
        forms = kind.by_mark(search.fit.frame)
        if forms and not _simulated(search, kind):
            found.append(have.get(kind.name) or _best(search, added, forms))
    return (*found, *shown(search, added))


def grids(search: Search, added: Added) -> Added:
    """Return the effects that a grid of recorded ranges shows, as they are where among `added`.

    No model of the error has a part in that: the ranges themselves lie on it.
    """
    have = {effect.name: effect for effect in added}
    kinds = [kind for kind in search.kinds.values() if kind.marked and fits_itself(kind)]
    found = []
    for kind in (one for one in kinds if not _simulated(search, one)):
        seen = Guard().safely(kind.name, with_values, None)
        made = have.get(kind.name) or seen(search.comparison, search.sharpest, (), kind)
        if made and (
            kind.name in have or (_matters(search, added, made) and not _borne(search, made))
        ):
            found.append(made)
    return tuple(found)


def _borne(search: Search, effect: Effect) -> bool:
    """Return whether the rows of another simulator's table bear a mark as recorded ones do."""
    other = search.comparison
    return isinstance(other, TableComparison) and effect.borne_by(other.frame)


def _matters(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether what an effect does to ranges is no small part of how rows of a link scatter.

    Beside what is `added`, and to those that it moves at all, which may be of one device of many.
    What links keep by themselves, such as a delay, may not be found yet and hides no rounding.
    """
    made, bare = (
        search.comparison.ensemble(search.sharpest, some, RESIDUAL_MEMBERS)
        for some in ((*added, effect), added)
    )
    change = made.simulated_of(RANGE) - bare.simulated_of(RANGE)
    moved = change[:, (np.abs(change) > 0).any(axis=0)]
    left = bare.residual_of(RANGE)
    links = pd.Series(left).groupby(search.sharpest.links)
    within = (left - links.transform("median"))[links.transform("count") > 1]
    own = MAD_TO_STD * float(np.nanmedian(np.abs(within if len(within) else left)))
    least = MARK_SHARE if _printed(effect) else ODD_MARK_SHARE
    return bool(moved.size) and float(np.nanstd(moved)) > least * own


def _printed(effect: Effect) -> bool:
    """Return whether a grid may be that of how numbers are printed: in a decimal place of metres.

    One of devices of their own may be, too, as numbers of each may be printed otherwise.
    """
    if not isinstance(effect, RangeRounding) or effect.steps_m or effect.growth:
        return True
    places = np.log10(effect.step_m)
    return bool(abs(places - np.rint(places)) < PRINTED)


def seen_first(state: State, located: Located) -> State:
    """Return the state with the effects in it that ranges bear the mark of, before all others.

    What is rounded scatters, and is off by much where rows stand still: other causes are weighed
    beside it, or they would have to stand for it.
    """
    known = {turn.added.name for turn in state.rounds if turn.added}
    have = {effect.name for effect in state.added}
    if state.search.fit.waveform or state.added:
        return state
    for seen in marked(state.search):
        if seen.name not in known | have:
            effect = likeliest(state.search, seen)
            turn = _first_round(state.search, located, state.added, effect)
            state = replace(state.after(turn), added=(*state.added, effect))
    return state


def likeliest(search: Search, effect: Effect, added: Added = ()) -> Effect:
    """Return the form of an effect beside which, and `added`, ranges speak most for some causes.

    The first, as rounding to the nearest is, unless another leads it clearly.
    """
    forms = effect.forms()
    if len(forms) == 1:
        return effect
    worth = [worth_beside(search, (*added, form)) - form.chosen_nats for form in forms]
    best = int(np.argmax(worth))
    best = best if worth[best] > worth[0] + FORM_LEAD_NATS else 0
    alike = [f for f, w in zip(forms, worth, strict=True) if w > worth[best] - FORM_LEAD_NATS]
    return forms[best].not_told_from(tuple(alike))


def _first_round(search: Search, located: Located, before: Added, effect: Effect) -> Round:
    """Return a round that adds an effect by its mark, with what a regression could remove."""
    focus = tuple(dict.fromkeys(finding.cell.observable for finding in located.findings))
    turn = announced(search, Round(located, None, None), (*before, effect), effect)
    assert turn.explanation is not None
    made = regressed(search.comparison, search.fit, search.discover, before, focus)
    nuisance, base = tally(made), turn.explanation.base
    removable = gain_interval(base, nuisance, search.seed)
    return replace(
        turn, explanation=replace(turn.explanation, nuisance=nuisance, removable=removable)
    )


def forms_of_marks(search: Search) -> list[tuple[Effect, ...]]:
    """Return the forms of every effect whose mark recorded rows bear and simulated ones do not.

    What logs of the receiver show is one, too.
    """
    able = (kind for kind in search.kinds.values() if not _simulated(search, kind))
    forms = [forms for forms in (kind.by_mark(search.fit.frame) for kind in able) if forms]
    return [*forms, *(effect.forms() for effect in search.logged)]


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


def idle(held: Checked, likely: Collection[str] = ()) -> set[str]:
    """Return the names of effects that only their mark speaks for.

    They are stated, but not put into the simulator: they help no link they were not fitted on. Of
    those that a likelihood of links found `likely`, the ones with which these score no better:
    beside one simulated row a score of twenty figures hardly falls, and is no word against them.
    """
    alone = [turn for turn in held.rounds if turn.added and turn.explanation and not turn.strike]
    gains = {t.added.name: t.explanation.contenders for t in alone if t.added and t.explanation}
    bare = {name for name, every in gains.items() if len(every) == 1}
    scores = {name: gains[name][0].gain for name in bare}
    told = {n for n, one in scores.items() if one.likely_above_zero}
    return bare - told - {n for n in likely if n in scores and scores[n].value > 0}


def _announced(search: Search, held: Checked, added: Added, effect: Effect) -> tuple[Round, ...]:
    """Return the rounds with one before the last that adds an effect by its mark."""
    *earlier, last = held.rounds
    return (*earlier, announced(search, last, added, effect), last)
