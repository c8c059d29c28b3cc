"""The errors and levels that a table's rows have already, as first effects on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect
from bench.physics.randomness import BLOCK, Draws
from bench.physics.units import Floats


@dataclass(frozen=True, eq=False)
class AsSimulated(Effect):
    """Errors `error_m` [n] of all rows, so that what rounds a range rounds all of it."""

    name = "as simulated"
    stage = "ranging"
    source = "the table"
    first = True

    error_m: Floats

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the errors, block by block."""
        start = draws.block * BLOCK
        return batch.longer(np.asarray(self.error_m[start : start + len(batch)]))


@dataclass(frozen=True, eq=False)
class AsReceived(Effect):
    """What levels of all rows depart by from a bare simulation, `level_db` [n].

    So what follows the level follows that of the row, its shadowing included.
    """

    name = "as received"
    stage = "receiver"
    source = "the table"
    first = True

    level_db: Floats

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Let signals arrive as strong as in the table, block by block."""
        start = draws.block * BLOCK
        own = self.level_db[start : start + len(batch)]
        return altered(batch, level_dbm=np.asarray(batch.level() + own))
