"""What names leave, but the set they are of does not, is another form of them.

A set weighs what causes can do, each in any form that physics allows; the effects that stand for
them have one form of few values. Where nothing is found in ranges beside all that the set does,
what is found beside the effects has the names of the set.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.own_scatter import left_by_causes
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import ranges_left
from bench.discrepancy.sets.choice import MERE
from bench.discrepancy.sets.mere_constant import swing_m
from bench.discrepancy.sets.shifted import Shifted


def left_by_names(search: Search, added: Added, last: Round) -> bool:
    """Return whether all that a last round finds is what named causes do themselves."""
    return left_by_causes(search, added, last.located.findings) or of_form(search, added, last)


def of_form(search: Search, added: Added, last: Round) -> bool:
    """Return whether nothing is found in ranges beside a set of causes, all of which are named.

    Asked where ranges alone were found.
    """
    choice, rows = search.choice, search.work
    named = {effect.physics for effect in added}
    seen = {one.cell.observable for one in last.located.findings}
    if rows is None or not choice.names or not set(choice.names) <= named or seen - {RANGE}:
        return False
    if set(choice.others) - ({MERE} if pulled(search, rows) else set()):
        return False
    shift_m = np.sum(list(choice.shifts_m.values()), axis=0)
    if len(shift_m) != len(rows.rows):
        return False
    beside = tuple(effect for effect in added if effect.physics not in choice.names)
    known = replace(search, comparison=Shifted(search.comparison, shift_m))
    return not ranges_left(known, beside).significant


def pulled(search: Search, rows: View) -> bool:
    """Return whether a name of a set goes up and down by more than a constant beside it.

    A reflection pulls whatever a receiver finds to one side in the mean, and an antenna is late in
    the mean over its directions: a constant that is smaller than what goes up and down is theirs.
    """
    shifts_m = search.choice.shifts_m
    constant = np.abs(shifts_m.get(MERE, np.zeros(len(rows.rows)))).max(initial=0.0)
    return swing_m(shifts_m) > float(constant)
