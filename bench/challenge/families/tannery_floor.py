"""The tannery: purlins over pits and drums, what nobody knows of it, and rows that effects read.

numpy and pandas alone. A long shed: pits of liquor in its floor, walkways of planks between them,
drums hooped with steel along both walls, and rails below the roof on which hoists carry hides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
SHED_M = (18.0, 46.0, 6.2)
PURLINS_M = np.array(
    [(2.1, 1.4, 4.4), (9.3, 3.2, 5.6), (16.7, 6.1, 4.9), (1.3, 15.8, 5.2), (16.2, 20.4, 5.7),
     (8.4, 24.9, 4.6), (1.9, 32.7, 5.5), (15.8, 36.3, 4.2), (9.9, 44.6, 5.0)]
)  # fmt: skip
DRUMS_M = np.array(
    [(15.4, 10.5), (2.6, 9.0), (15.3, 17.5), (2.7, 22.0), (15.4, 27.5), (2.6, 28.5), (15.2, 41.0),
     (2.8, 39.5)]
)  # fmt: skip
HOISTS = 6
SOAKED = {"wood": (0.13, 1.99, 2.6), "brick": (0.115, 3.91, 4.6), "chipboard": (0.1, 2.58, 3.1)}
"""Stacks of planks, a party wall, boards that hides are nailed to: m, permittivity, dB."""
WATER = 78.0  # permittivity
HAUL = ("course_rad", "pace_m_per_s", "swing_m", "swing_rad")
ROPE_RAD_PER_S = 1.94  # of hides that swing below a hoist: 2.6 m of rope
RAIL_M = 5.6  # height of the hoists' rails
HALF_PPM_M = 149.896229  # metres per ppm and second of a reply
GHZ = 3.4944  # channel 1
WAVE_M = 0.299792458 / GHZ
FUSS_M = 0.313853  # the Rhenish one
SHIFT_S = 7.0 * 3600
LAWS = {
    "hides-soaked": Law(("power", "parabola")),
    "drums-reverse": Law(("periodic",), 680.0, "s", grows=False),
    "drying-loft-opened": Law(("step",), 0.128, "m"),
    "lime-cakes": Law(("saturation", "logarithm", "power")),
    "tallow-on-domes": Law(("logarithm", "power", "saturation")),
    "liquor-rises": Law(("linear", "power")),
    "span-wires-slack": Law(("inverse", "power", "inverse square")),
    "ropes-stretch": Law(),
    "weak-edges-corrected": Law(),
    "purlin-replaced": Law(("position",), 0.515, "m", devices=("purlin6",)),
    "purlins-miswired": Law(("swap",), devices=("purlin0", "purlin4")),
    "feet-from-one-purlin": Law(("unit",), 1 / FUSS_M, "1", grows=False, devices=("purlin2",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Dye:
    """What rows are dyed with [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Lot:
    """Rows of a table; `week` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    week: int
    rng: np.random.Generator
    seldom: bool = False

    def of(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name], np.float64).copy()

    @property
    def way(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @property
    def purlin(self) -> NDArray[np.intp]:
        """Numbers of purlins [n]."""
        return np.array([int(one.removeprefix("purlin")) for one in self.table["rx"]], np.intp)

    @property
    def hoist(self) -> NDArray[np.intp]:
        """Numbers of hoists [n]."""
        return np.array([int(one.removeprefix("hoist")) for one in self.table["tx"]], np.intp)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.week, what, 892])

    def each_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        codes = self.table["link"].astype("category").cat.codes.to_numpy()
        return np.asarray(made(int(codes.max()) + 1), np.float64)[codes]

    def bolts(self) -> Floats:
        """Return where purlins have their antennas, as is written down [n, 3], in m."""
        return PURLINS_M[self.purlin]

    def hides(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later: carried on, and swinging [n, 3], in m."""
        course, pace, swing, phase = (self.of(name) for name in HAUL)
        after = phase + ROPE_RAD_PER_S * np.asarray(later_s)
        gone = pace * later_s + swing * (np.sin(after) - np.sin(phase))
        ahead = [np.cos(course) * gone, np.sin(course) * gone, 0 * gone]
        return np.stack([self.of(f"tx_{a}_m") + go for a, go in zip("xyz", ahead, strict=True)], 1)

    def longer(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.longer_from(self.hides(later_s))

    def longer_from(self, hides_m: Floats) -> Floats:
        """Return by how much ways from tags at [n, 3] are longer, in m [n]."""
        return np.asarray(np.linalg.norm(self.bolts() - hides_m, axis=1) - self.way)

    def crosses(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.fromiter((kind in one for one in self.table["obstacles"]), np.float64)
