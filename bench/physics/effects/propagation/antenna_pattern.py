"""Effect 5: delay and gain of the antennas depend on the direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.specular import positions
from bench.physics.randomness import Draws
from bench.physics.scene import Scene, scene
from bench.physics.units import C_M_PER_NS, Floats

TYPICAL_M = 0.1  # of the first harmonic [source: Ledergerber 2018]
WIDEST_M = 0.5  # over all directions: 0.2 m was measured; what is more stands in the way
KNOWN_SHARE = 0.9  # of the headings
SECTORS = 12  # of a circle
WIDEST_GAP = 2 * np.pi / 3  # between headings that lie all around: three are enough


@dataclass(frozen=True)
class AntennaPattern(Effect):
    """Group delay and gain vary with the heading: a first and a second harmonic.

    The heading is `azimuth_deg` where known, else the bearing from `rx` to `tx`. All paths are
    shifted alike (the pattern of the strongest direction); rows without a heading are left alone.
    """

    name = "antenna-pattern"
    number = 5
    stage = "propagation"
    stackable = True
    source = "Ledergerber and D'Andrea, IEEE Access 6 (2018); up to 10-20 cm over direction"
    signature = "periodic in the heading or the bearing from rx to tx, the same at all distances"
    control = "rows without a known heading"
    needs = (("azimuth_deg",), ("tx_x_m", "tx_y_m", "rx_x_m", "rx_y_m"))

    delay_m: float = parameter(0, "m", 0, 0.5, "first harmonic of the range", null=0)
    delay_2_m: float = parameter(0, "m", 0, 0.5, "second harmonic of the range", null=0)
    gain_db: float = parameter(0, "dB", 0, 15, "first harmonic of the gain", null=0)
    phase_deg: float = parameter(0, "deg", -180, 180, "heading of the longest delay")
    phase_2_deg: float = parameter(0, "deg", -180, 180, "of the second harmonic")

    @classmethod
    def unmarked(cls, frame: pd.DataFrame) -> str:
        """Return that headings fill no circle: over a few of them a pattern is a constant."""
        if all_around(heading_rad(scene(frame, "recorded"))):
            return ""
        return "headings all around (azimuth_deg, or bearings between positions)"

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return the first four harmonics of the heading; None where most are unknown."""
        turn = heading_rad(rows)
        known = np.isfinite(turn)
        if known.mean() < KNOWN_SHARE:
            return None
        turn = np.where(known, turn, 0.0)
        every = [
            TYPICAL_M / k**1.5 * np.where(known, wave(k * turn), 0.0)
            for k in (1, 2, 3, 4)
            for wave in (np.sin, np.cos)
        ]
        return (np.stack(every, axis=1),)

    @classmethod
    def tellable(cls, rows: Scene) -> bool:
        """Return whether headings lie all around: over a few of them a pattern is a constant."""
        return all_around(heading_rad(rows))

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:  # noqa: ARG003
        """Return whether ranges differ over the direction by no more than antennas make."""
        return float(np.ptp(shift_m)) <= WIDEST_M

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Shift and weaken all paths by heading."""
        turn = heading_rad(batch.rows)
        first = np.cos(turn - np.radians(self.phase_deg))
        second = np.cos(2 * (turn - np.radians(self.phase_2_deg)))
        late = (self.delay_m * first + self.delay_2_m * second) / C_M_PER_NS
        known = np.isfinite(turn)
        return batch.postponed(np.where(known, late, 0.0)).louder(
            np.where(known, -self.gain_db * first, 0.0)
        )

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows without a known heading."""
        return ~np.isfinite(heading_rad(batch.rows))


def all_around(turn: Floats) -> bool:
    """Return whether headings [n] in radians are known and lie all around.

    In half of a circle's sectors, or nowhere farther apart than a third of the circle.
    """
    known = np.isfinite(turn)
    if known.mean() < KNOWN_SHARE:
        return False
    turn = np.sort(turn[known] % (2 * np.pi))
    sectors = np.unique(np.floor(turn * SECTORS / 2 / np.pi))
    gaps = np.diff(turn, append=turn[0] + 2 * np.pi)
    return bool(len(sectors) >= SECTORS / 2 or gaps.max() <= WIDEST_GAP + 1e-9)


def waves(rows: Scene) -> tuple[Floats, ...]:
    """Return the first two harmonics of `azimuth_deg` [n] each, none where no row has it.

    As a number a heading tells little: the largest lies beside the least.
    """
    turn = np.radians(rows.number("azimuth_deg", np.nan))
    if not np.isfinite(turn).any():
        return ()
    return harmonics(turn, 2)


def harmonics(turn: Floats, many: int) -> tuple[Floats, ...]:
    """Return cosine and sine [n] each of so `many` multiples of an angle [n] in radians."""
    multiples = range(1, many + 1)
    return tuple(np.asarray(wave(k * turn)) for k in multiples for wave in (np.cos, np.sin))


def heading_rad(rows: Scene) -> Floats:
    """Return `azimuth_deg` or the bearing from rx to tx [n] in radians, NaN where unknown.

    Remembered: not to be written into.
    """

    def made() -> Floats:
        way = positions(rows, "tx") - positions(rows, "rx")
        bearing = np.where(np.isfinite(way[:, 0]), np.arctan2(way[:, 1], way[:, 0]), np.nan)
        azimuth = np.radians(rows.number("azimuth_deg", np.nan))
        return np.where(np.isfinite(azimuth), azimuth, bearing)

    found: Floats = rows.known.get("heading", made)
    return found
