"""Whether a search runs this project's code alone, so that it may be forked."""

from __future__ import annotations

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.select.state import Search
from bench.physics.ours import is_ours


def runs_own_code(search: Search) -> bool:
    """Return whether all effects of a search and its simulator, if it is run again, are ours."""
    parts: list[type] = [*search.kinds.values()]
    if isinstance(search.comparison, Resimulation):
        simulator = search.comparison.simulator
        parts += map(type, (simulator, simulator.base, *simulator.effects))
    return all(map(is_ours, parts))
