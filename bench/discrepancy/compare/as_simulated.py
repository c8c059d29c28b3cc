"""The errors that a table's rows have already, as the first effect on their ranges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch
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
