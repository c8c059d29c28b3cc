"""What names leave, but the set they are of does not, is another form of them.

A set weighs what causes can do, each in any form that physics allows; the effects that stand for
them have one form of few values. Where nothing is found in ranges beside all that the set does,
what is found beside the effects has the names of the set.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.own_scatter import left_by_causes
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import ranges_left
from bench.discrepancy.sets.shifted import Shifted


def left_by_names(search: Search, added: Added, last: Round) -> bool:
    """Return whether all that a last round finds is what named causes do themselves."""
    return left_by_causes(search, added, last.located.findings) or _of_form(search, added, last)


def _of_form(search: Search, added: Added, last: Round) -> bool:
    """Return whether nothing is found in ranges beside a set of causes, all of which are named.

    Asked where ranges alone were found.
    """
    choice, rows = search.choice, search.work
    named = {effect.physics for effect in added}
    cells = [one.cell for one in last.located.findings]
    if rows is None or not choice.names or choice.others or not set(choice.names) <= named:
        return False
    shift_m = np.sum(list(choice.shifts_m.values()), axis=0)
    if len(shift_m) != len(rows.rows) or any(cell.observable != RANGE for cell in cells):
        return False
    beside = tuple(effect for effect in added if effect.physics not in choice.names)
    known = replace(search, comparison=Shifted(search.comparison, shift_m))
    return not ranges_left(known, beside).significant
