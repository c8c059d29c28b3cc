"""Effect 14: the power falls differently with distance, and shadowing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.ways import lacking_levels


@dataclass(frozen=True)
class PathLoss(Effect):
    """Changes the free-space level: PL0 + 10 n log10 d + shadowing per link.

    Published exponents (IEEE 802.15.4a): residential 1.79 with and 4.58 without line of sight,
    office 1.63 and 3.07, outdoor 1.76 and 2.5; free space 2. A slope that begins some metres away
    says of 1 m less than free space: of 4.58 from 6 m on, 20 dB less. What stands or falls all
    along the way (leaves, snow) takes so many dB of every metre: ITU-R P.833, 0.2 to 1 in leaf.
    """

    name = "path-loss"
    number = 14
    stage = "propagation"
    stackable = True
    source = "Molisch et al., IEEE 802.15.4a channel model final report (2004), section 2"
    signature = (
        "receive level over log distance has another slope: what is simulated with an exponent n "
        "has n + exponent - 2 with it; scatter per position"
    )
    per_link = True  # the shadowing
    essential = ("exponent",)
    instead = ("per_metre_db",)

    exponent: float = parameter(2, "1", 1, 5, "n", null=2)
    offset_db: float = parameter(0, "dB", -20, 30, "loss beyond free space at 1 m", null=0)
    shadowing_db: float = parameter(0, "dB", 0, 12, "std over links", null=0)
    per_metre_db: float = parameter(
        0, "dB/m", 0, 1, "absorbed all along the way", null=0, fitted=False
    )

    @classmethod
    def unmarked(cls, frame: pd.DataFrame) -> str:
        """Return that no level is recorded."""
        return lacking_levels(frame)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Weaken all paths by the loss beyond free space."""
        distance_db = 10 * np.log10(np.maximum(batch.rows.true_range_m, 0.05))
        shadow = self.shadowing_db * draws.group_normal(batch.rows.group("link"))
        lost = (self.exponent - 2) * distance_db + self.offset_db
        return batch.louder(shadow - lost - self.per_metre_db * batch.rows.true_range_m)
