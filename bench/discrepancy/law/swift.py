"""Periods shorter than the grid has: a pendulum over hours, supports of a belt over its whole way.

Rows that come at any time show periods far below their spacing (Scargle 1982, ApJ 263), but a grid
of thousands of them times every factor would cost minutes. So these are sought in all rows alike,
of what goes on over many periods alone: times, and ways of the user's own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from bench.discrepancy.law.between import over_places
from bench.discrepancy.law.forms import Form, over_what, spacing_of, wave_sums
from bench.discrepancy.law.material import Column, Floats, Material
from bench.discrepancy.law.settings import (
    LAW_CYCLE_STEP,
    LAW_NYQUIST,
    LAW_SWIFT_CYCLES,
    LAW_SWIFT_ROWS,
)
from bench.discrepancy.law.structures import GridLaw

GEOMETRY = ("true_range_m",)  # goes on over few periods


def swift(
    given: Material, target: Floats, grids: Mapping[tuple[Form, int], Floats]
) -> Iterator[GridLaw]:
    """Yield, of every column that may show it, the short period that removes most of a target [n].

    `grids` are the constants of every form over a column that are screened (see `promising`).
    """
    for (form, at), longer in grids.items():
        column = over_what(given, at)
        grid = _short(column, longer) if form.free == "period" else np.empty(0)
        if not len(grid):
            continue
        best = int(np.argmax(_power(column.values, target, grid)))
        near = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
        names = (column.text, column.words, "", "", "1")
        law = GridLaw(form, at, 0, False, float(grid[best]), _sorted(*near), 2 * len(grids), names)
        yield from (law, replace(law, offset=True))


def _sorted(one: float, two: float) -> tuple[float, float]:
    return float(min(one, two)), float(max(one, two))


def _short(column: Column, grid: Floats) -> Floats:
    """Return the periods below those of the grid, longest first; none that places do not show."""
    if over_places((column.text,)) or column.text in GEOMETRY:
        return np.empty(0)
    known = np.unique(column.values[np.isfinite(column.values)])
    span = float(known[-1] - known[0])
    cycles = np.arange(span / grid[-1] + LAW_CYCLE_STEP, LAW_SWIFT_CYCLES, LAW_CYCLE_STEP)
    every = span / cycles
    least = LAW_NYQUIST * spacing_of(known, span / LAW_SWIFT_CYCLES) if len(every) else 0.0
    return np.asarray(every[every > least])


def _power(values: Floats, target: Floats, periods: Floats) -> Floats:
    """Return how much of a target [n] a wave of each period [G] removes.

    Of so many rows, evenly, as show it. As sine and cosine over many turns have nothing in common:
    the periodogram.
    """
    known = np.flatnonzero(np.isfinite(values))
    known = known[:: -(-len(known) // LAW_SWIFT_ROWS)]
    at, left = values[known] - values[known].min(), target[known] - target[known].mean()
    return wave_sums(at, periods, left)
