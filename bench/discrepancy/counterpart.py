"""How many rows both sides of a comparison have, and which of the recorded ones take part."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Comparison
from bench.physics.simulator import Simulator
from bench.recordings.clean import describe
from bench.recordings.table import Recordings


def counted(recorded: Recordings, simulated: Simulator | Recordings) -> tuple[str, ...]:
    """Return how many rows of how many links each table has, and what was left out, in words."""
    tables = {"recorded": recorded}
    if isinstance(simulated, Recordings):
        tables["simulated"] = simulated
    return tuple(f"{side}: {_words(table)}" for side, table in tables.items())


def _words(table: Recordings) -> str:
    links = f" of {table.frame['link'].nunique()} links" if "link" in table.frame else ""
    lost = f"; left out: {describe(table.dropped)}" if table.dropped else ""
    return f"{len(table)} rows{links}{lost}"


def covered(comparison: Comparison, recorded: Recordings) -> NDArray[np.bool_]:
    """Return which rows [n] the simulated side has a counterpart of: all, but for tables."""
    if isinstance(comparison, TableComparison):
        return comparison.covered(recorded.frame)
    return np.ones(len(recorded), bool)
