"""Effect 2: the range depends on the received power ("time walk")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats
from bench.physics.ways import known_mostly, lacking_levels, smooth_columns

TYPICAL_M, LENGTH_DB = 0.08, 5.0  # of the published curve
TENTHS = (0.1, 0.9)  # where weak and strong signals begin
LEVELS_DBM = np.arange(-93.0, -60.0, 2.0)  # of the published curve
LARGEST, LEVELS_OFF_DB, SLACK_M = 2.5, 4.0, 0.03  # of the published curve: other pulse rates have
# 2.5 times its size, and budgets are known to some decibels [source: APS011]
KNOTS_DBM = np.arange(-100.0, -40.0, 3.0)
ALIKE_DB = 1.5  # between tenths of levels that only scatter: they show no direction


@dataclass(frozen=True)
class PowerBias(Effect):
    """Strong signals read short, weak ones long: an S-curve in the TRUE receive level.

    -11 cm at -61 dBm, 0 at -77 dBm, +8.1 cm at -93 dBm (64 MHz PRF, 500 MHz channels). The level
    is the true one, not the compressed one the chip reports.
    """

    name = "power-bias"
    number = 2
    stage = "ranging"
    stackable = True
    source = "Decawave application note APS011, version 1.0, table 2"
    signature = "an S-curve of error over receive level at fixed distance, in line of sight too"
    follows = "rx_power_dbm"

    scale: float = parameter(1, "ratio", 0, 3, "of the published curve", null=0)
    shift_db: float = parameter(0, "dB", -20, 20, "the level at which the published 0 dB lies")

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return smooth curves over the logged level, of the size of the published one."""
        level = known_mostly(rows.number("rx_power_dbm", np.nan))
        if level is None:
            return None
        return (TYPICAL_M * smooth_columns(level, KNOTS_DBM, LENGTH_DB),)

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:
        """Return whether weak signals are long and strong ones short, near the published curve.

        But for a constant: antennas are calibrated at some level, where ranges read right then.
        """
        level = rows.number("rx_power_dbm", np.nan)
        low, high = np.nanquantile(level, TENTHS)
        ends = [level <= low, level >= high]
        weak, strong = (float(np.mean(shift_m[those])) for those in ends)
        low, high = (float(np.mean(level[those])) for those in ends)
        longest, above = (max(_largest(end - LEVELS_OFF_DB), 0) for end in (low, high))
        shortest = min(_largest(high + LEVELS_OFF_DB), 0)
        rises = weak > strong or high - low < ALIKE_DB
        least = max(weak - longest - SLACK_M, strong - above - SLACK_M, -longest)
        most = min(strong - shortest + SLACK_M, -shortest)  # of what calibration may add
        return bool(rises and least <= most)

    @classmethod
    def unmarked(cls, frame: pd.DataFrame) -> str:
        """Return that no level is recorded."""
        return lacking_levels(frame)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the bias at each row's true receive level."""
        return batch.longer(self.scale * published_bias_m(batch.level() - self.shift_db))


def _largest(level_dbm: float) -> float:
    """Return the largest bias that any pulse rate has at a level.

    Of signals weaker than any that were published as they go on there at last: their edges rise no
    faster.
    """
    end_dbm, last_m = LEVELS_DBM[0], published_bias_m(LEVELS_DBM[:2])
    beyond_m = (last_m[0] - last_m[1]) / np.ptp(LEVELS_DBM[:2]) * max(end_dbm - level_dbm, 0.0)
    return LARGEST * float(published_bias_m(np.array([level_dbm]))[0] + beyond_m)


def published_bias_m(level_dbm: Floats) -> Floats:
    """Return the bias in metres at true receive levels in dBm, linear between the table's points.

    Beyond the table (-61 to -93 dBm) the last value is kept.
    """
    bias_cm = [8.1, 7.6, 7.1, 6.2, 4.9, 4.2, 3.5, 2.1, 0, -2.7, -5.1, -6.9, -8.2, -9.3]
    bias_cm += [-10.0, -10.5, -11.0]
    return np.asarray(np.interp(level_dbm, LEVELS_DBM, np.array(bias_cm) / 100))
