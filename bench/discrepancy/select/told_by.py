"""Sizes that something else tells better than a fit: rows of links, links, obstacles one by one."""

from __future__ import annotations

from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.level_slope import told_by_links
from bench.discrepancy.select.per_obstacle import told_by_obstacles
from bench.discrepancy.select.scatter_size import told_by_rows
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.told_by_levels import told_by_levels
from bench.physics.effect import Effect

TOLD_BY = {
    "size of scatter": told_by_rows,
    "slope of levels": told_by_links,
    "metres per obstacle": told_by_obstacles,
    "losses": told_by_levels,
}


def told_otherwise(
    search: Search, others: Added, effect: Effect, fitted: tuple[ParameterEstimate, ...]
) -> tuple[ParameterEstimate, ...]:
    """Return the intervals of an effect beside others, those of its fit where nothing else tells.

    What fails leaves them as they are.
    """
    for step, told in TOLD_BY.items():
        fitted = Guard().safely(step, told, fitted)(search, others, effect, fitted)
    return fitted
