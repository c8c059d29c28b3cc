"""Effect 6: timestamps scatter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import C_M_PER_NS


@dataclass(frozen=True)
class TimestampJitter(Effect):
    """Adds independent noise to every range: clock jitter and the estimate of the edge.

    In clean recorded links the first-path index spreads by 0.07 to 0.11 samples and the range by
    15 to 30 mm. `heavy` is the share of rows with five times the spread.
    """

    name = "timestamp-jitter"
    number = 6
    stage = "ranging"
    stackable = True
    source = "measured on Zenodo 10.5281/zenodo.4742391"
    signature = "independent scatter of every range, the same everywhere"
    independent = True

    jitter_samples: float = parameter(0.08, "samples", 0, 2, "std of the first path", null=0)
    heavy: float = parameter(0, "ratio", 0, 0.5, "share of rows with five times the spread")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Scatter the ranges; the waveform stays as it is."""
        size = np.where(draws.uniform(len(batch)) < self.heavy, 5.0, 1.0)
        late = self.jitter_samples * size * draws.normal(len(batch))
        return batch.longer(C_M_PER_NS * batch.sample_period_ns * late)
