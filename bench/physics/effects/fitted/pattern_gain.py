"""Gain over the heading as two harmonics, for antennas whose waveforms are compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern, heading_rad
from bench.physics.randomness import Draws
from bench.physics.units import Floats


@dataclass(frozen=True)
class PatternGain(Effect):
    """Gain of the antennas over the heading: its mean, and waves of two harmonics.

    What a pattern does to waveforms, which are compared from the first path on and do not see how
    late that is; ranges say the delay. In waves, because a search along amplitude and phase ends at
    whatever phase it begins with. What is lost behind a back is lost in the mean, too: without one,
    a path loss of the slope of free space would stand for it.
    """

    name = "pattern-gain"
    explains: ClassVar[str] = AntennaPattern.name
    contains = (AntennaPattern.name,)
    fitted: ClassVar[bool] = False
    stage = "propagation"
    stackable = True
    source = "Ledergerber and D'Andrea, IEEE Access 6 (2018); waves fitted to recordings"
    signature = AntennaPattern.signature
    control = AntennaPattern.control
    needs = (("azimuth_deg",),)

    cos_db: float = parameter(0, "dB", -9, 9, "gain ahead, of the first harmonic", null=0)
    sin_db: float = parameter(0, "dB", -9, 9, "gain at 90 degrees, of the first", null=0)
    cos_2_db: float = parameter(0, "dB", -9, 9, "gain ahead, of the second harmonic", null=0)
    sin_2_db: float = parameter(0, "dB", -9, 9, "gain at 45 degrees, of the second", null=0)
    mean_db: float = parameter(0, "dB", -9, 9, "gain in the mean of all headings", null=0)

    @classmethod
    def unmarked(cls, frame: pd.DataFrame) -> str:
        """Return that headings fill no circle, as of a pattern."""
        return AntennaPattern.unmarked(frame)

    def gain_db(self, turn: Floats) -> Floats:
        """Return the gain at headings [n] in radians, NaN where one is not known."""
        first = self.cos_db * np.cos(turn) + self.sin_db * np.sin(turn)
        second = self.cos_2_db * np.cos(2 * turn) + self.sin_2_db * np.sin(2 * turn)
        return np.asarray(self.mean_db + first + second)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Strengthen all paths by heading, where it is known."""
        return batch.louder(np.nan_to_num(self.gain_db(heading_rad(batch.rows))))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows without a known heading."""
        return ~np.isfinite(heading_rad(batch.rows))
