"""Effect 23: ranges written down in steps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws


@dataclass(frozen=True)
class RangeRounding(Effect):
    """Ranges are rounded to a step, as firmware that prints centimetres or decimetres does.

    It looks like jitter of step / sqrt(12), but every range is a multiple of the step.
    """

    name = "range-rounding"
    number = 23
    stage = "ranging"
    source = "uniform quantisation: Widrow and Kollar, Quantization Noise, Cambridge 2008, ch. 5"
    signature = "ranges are multiples of a step; error uniform within half of it; CIR unchanged"
    last = True
    independent = True

    step_m: float = parameter(0.0, "m", 0, 1, "rounding step of the range", null=0)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Round the ranges to the step."""
        if self.step_m == 0 or batch.range_m is None:
            return batch
        return replace(batch, range_m=np.rint(batch.range_m / self.step_m) * self.step_m)
