"""Intervals beside what recordings do not tell: which way a receiver rounds, say.

Firmware that cuts ranges down to a grid, and firmware that goes to the nearest point, differ by a
constant of half a step. Where another effect can take that constant, its values hold only
together with a way of rounding; so their intervals span those of every way that is as likely.
"""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.sandwich import Intervals
from bench.discrepancy.select.backfitting import once_more
from bench.discrepancy.settings import UNDETERMINED
from bench.physics.effect import Effect

Estimates = tuple[ParameterEstimate, ...]


def over_forms(
    intervals_of: Intervals, comparison: Comparison, view: View, others: Added, effect: Effect
) -> Estimates:
    """Return the intervals of an effect, beside every form of the others that is as likely."""
    found = intervals_of(comparison, view, others, effect)
    for beside in _others_as_likely(others):
        moved = once_more(comparison, view, (*beside, effect), effect)
        made = {one.name: one for one in intervals_of(comparison, view, beside, moved)}
        found = tuple(_spanning(one, made.get(one.name, one), effect) for one in found)
    return (*found, *_of_its_own(effect, found))


def _others_as_likely(others: Added) -> list[Added]:
    """Return the other effects with one of them in another form, for each such form."""
    return [
        tuple(form if one is changed else one for one in others)
        for changed in others
        for form in changed.forms_as_likely()
    ]


def _spanning(
    one: ParameterEstimate, other: ParameterEstimate, effect: Effect
) -> ParameterEstimate:
    """Return an estimate whose interval spans that of another."""
    low, high = min(one.low, other.low), max(one.high, other.high)
    bounds = {p.name: p.high - p.low for p in effect.parameters()}
    known = high - low < UNDETERMINED * bounds.get(one.name, float("inf"))
    return replace(one, low=low, high=high, determined=bool(one.determined and known))


def _of_its_own(effect: Effect, found: Estimates) -> Estimates:
    """Return the parameters of the form of a mark beside those that were found.

    Not determined where forms are not told apart; else where they are not as by default.
    """
    known = {one.name.partition("[")[0] for one in found}
    forms, out = (effect, *effect.forms_as_likely()), []
    for item in effect.parameters() if type(effect).marked else ():
        values = [float(getattr(form, item.name)) for form in forms]
        told = len(set(values)) == 1
        if item.name not in known and not (told and values[0] == item.default):
            span = (item.name, values[0], min(values), max(values), item.unit)
            out.append(ParameterEstimate(*span, determined=told))
    return tuple(out)
