"""Effect 2: the range depends on the received power ("time walk")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import Floats


@dataclass(frozen=True)
class PowerBias(Effect):
    """Strong signals read short, weak ones long: an S-curve in the TRUE receive level.

    -11 cm at -61 dBm, 0 at -77 dBm, +8.1 cm at -93 dBm (64 MHz PRF, 500 MHz channels). The level
    is the true one, not the compressed one the chip reports.
    """

    name = "power-bias"
    number = 2
    stage = "ranging"
    source = "Decawave application note APS011, version 1.0, table 2"
    signature = "an S-curve of error over receive level at fixed distance, in line of sight too"
    follows = "rx_power_dbm"

    scale: float = parameter(1, "ratio", 0, 3, "of the published curve", null=0)
    shift_db: float = parameter(0, "dB", -20, 20, "the level at which the published 0 dB lies")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the bias at each row's true receive level."""
        return batch.longer(self.scale * published_bias_m(batch.level() - self.shift_db))


def published_bias_m(level_dbm: Floats) -> Floats:
    """Return the bias in metres at true receive levels in dBm, linear between the table's points.

    Beyond the table (-61 to -93 dBm) the last value is kept.
    """
    levels = np.arange(-93.0, -60.0, 2.0)
    bias_cm = [8.1, 7.6, 7.1, 6.2, 4.9, 4.2, 3.5, 2.1, 0, -2.7, -5.1, -6.9, -8.2, -9.3]
    bias_cm += [-10.0, -10.5, -11.0]
    return np.asarray(np.interp(level_dbm, levels, np.array(bias_cm) / 100))
