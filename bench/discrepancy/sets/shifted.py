"""A comparison whose simulator has some shifts of the ranges already, row by row."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Changed, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.calibrated import TAKEN_OFF
from bench.discrepancy.sets.choice import MERE
from bench.discrepancy.sets.set_up import is_fault

CONSTANTS = (TAKEN_OFF, MERE)


@dataclass(frozen=True)
class Shifted(Changed):
    """Another comparison, every simulated range of its rows longer by `shift_m` [n].

    Or another observable `name` larger, in its unit.

    Only for the view whose rows these are.
    """

    shift_m: NDArray[np.float64]
    name: str = RANGE

    def ensemble(self, view: View, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return recorded rows beside simulated versions, shifted."""
        made = self.comparison.ensemble(view, added, members, first)
        versions = made.versions.copy()
        versions[1:, :, made.place(self.name)] += self.shift_m
        return replace(made, versions=versions)


def beside_faults(search: Search, rows: View) -> Comparison:
    """Return the comparison whose simulated ranges have the faults of the set-up of the choice.

    Fitted without them, delays of devices would take of what one does that stands elsewhere, and a
    scale of a constant without a name. Only for the rows that the choice is of.
    """
    shifts_m = search.choice.shifts_m
    faults = [m for o, m in shifts_m.items() if is_fault(o) or o in CONSTANTS]
    if not faults or search.choice.view != rows.number:
        return search.comparison
    return Shifted(search.comparison, np.sum(faults, axis=0))


def beside_constants(search: Search, rows: View) -> Comparison:
    """Return the comparison whose simulated ranges have the constants of the choice, of no name.

    Names seem to make ranges worse without one: a scale of ranges whose mean error was taken off,
    a clock in ranges that are all a little short.
    """
    taken = [m for o, m in search.choice.shifts_m.items() if o in CONSTANTS]
    if not taken:
        return search.comparison
    # 0 in rows without a range
    constant_m = sum(float(one[np.argmax(np.abs(one))]) for one in taken)
    return Shifted(search.comparison, np.full(len(rows.rows), constant_m))
