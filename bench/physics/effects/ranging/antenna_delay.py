"""Effect 1: the delay between antenna and timestamp is not what was calibrated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats
from bench.physics.ways import device_columns

COMMON_M, OWN_M = 0.3, 0.2  # typical: of all devices, of each: nanoseconds [source: APS014]


@dataclass(frozen=True)
class AntennaDelay(Effect):
    """Shifts every range by c (delta_tx + delta_rx) / 2.

    `delay_ns` is the common error of the sum of both delays; `device_spread_ns` the standard
    deviation of each device's own.
    """

    name = "antenna-delay"
    number = 1
    stage = "ranging"
    stackable = True
    source = "Decawave application note APS014 on antenna delay calibration"
    signature = (
        "a constant over distance, power and line of sight; separable per pair of devices; 1 ns of "
        "both delays together is 0.15 m of range"
    )
    everywhere = True

    delay_ns: float = parameter(0, "ns", -20, 20, "error of both delays together", null=0)
    device_spread_ns: float = parameter(0, "ns", 0, 5, "std over devices", null=0, fitted=False)

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return a constant, and one per device."""
        tx, rx = device_columns(rows)
        return np.full((len(rows), 1), COMMON_M), OWN_M * (tx + rx)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by half the sum of both delays."""
        if self.device_spread_ns == 0:
            return batch.later(self.delay_ns / 2)
        own = sum(draws.group_normal(batch.rows.group(end)) for end in ("tx", "rx"))
        return batch.later((self.delay_ns + self.device_spread_ns * own) / 2)
