"""The quarry: masts on floor and benches, what nobody knows of it, and rows that effects read.

numpy and pandas alone. A pit for dimension stone: a floor, and a bench along one of its faces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
FACE_Y_M, BENCH_M = 46.0, 5.8  # where the upper face is; how high the bench before it
MASTS_M = np.array(
    [(2.0, 6.0, 3.6), (19.5, 1.5, 4.4), (40.0, 3.0, 3.2), (59.5, 9.0, 4.8),
     (61.0, 31.0, 5.2), (44.5, 39.0, 9.7), (24.0, 41.5, 10.3), (5.5, 36.0, 9.1)]
)  # fmt: skip
GENERATOR_M = np.array([33.0, 0.0])
DIGGERS = 4
STONE = {"marble": (0.085, 7.07, 4.1), "concrete": (0.1, 5.24, 5.6), "wood": (0.17, 1.99, 2.3)}
"""Sawn blocks, barriers, sheds: thickness in m, permittivity, loss in dB."""
SLEW = ("arm_m", "bearing_rad", "slew_rad_per_s", "hoist_m_per_s")
A_PPM = 299.792458 / 2  # metres per ppm and second
NANOSECOND_M = 0.299792458
CARRIER_GHZ = 4.4928  # channel 3
WAVE_M = NANOSECOND_M / CARRIER_GHZ
SHIFT_S = 7.5 * 3600
CHAIN_LINK_M = 0.201168  # a hundredth of Gunter's chain
LAWS = {
    "dust-cloud": Law(("power", "parabola")),
    "sump-pumped": Law(("periodic",), 470.0, "s", grows=False),
    "bucket-laden": Law(("linear", "power")),
    "rock-settles": Law(("inverse", "power", "inverse square")),
    "mud-on-domes": Law(("saturation", "logarithm", "power")),
    "puddles-spread": Law(("logarithm", "power", "saturation")),
    "generator-hunts": Law(("step",), 0.135, "m"),
    "stays-slacken": Law(),
    "boom-not-lowered": Law(),
    "heights-of-two-datums": Law(),
    "reports-by-exception": Law(),
    "mast-hauled-aside": Law(("position",), 0.57, "m", devices=("mast5",)),
    "masts-taken-for-each-other": Law(("swap",), devices=("mast2", "mast6")),
    "chain-links-from-one-mast": Law(
        ("unit",), 1 / CHAIN_LINK_M, "1", grows=False, devices=("mast3",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Load:
    """What is loaded on rows [n]: metres; dB of the whole, the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Spoil:
    """Rows of a table; `stratum` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    stratum: int
    rng: np.random.Generator
    scant: bool = False

    def __call__(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name].astype(np.float64).to_numpy())

    @cached_property
    def away(self) -> Floats:
        """True distances in m [n]."""
        return self("true_range_m")

    @cached_property
    def mast(self) -> NDArray[np.intp]:
        """Numbers of masts [n]."""
        return np.asarray(self.table["rx"].str[len("mast") :].to_numpy(str), np.intp)

    @cached_property
    def digger(self) -> NDArray[np.intp]:
        """Numbers of diggers [n]."""
        return np.asarray(self.table["tx"].str[len("digger") :].to_numpy(str), np.intp)

    def bedded(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stratum, 832, what])

    def link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        number, names = self.table["link"].factorize()
        return np.take(np.asarray(made(names.size), np.float64), number)

    def booms(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where booms end some time later: they slew about diggers, and rise [n, 3]."""
        arm, bearing, slew, hoist = (self(name) for name in SLEW)
        there = bearing + slew * later_s
        east = self("tx_x_m") + arm * (np.cos(there) - np.cos(bearing))
        north = self("tx_y_m") + arm * (np.sin(there) - np.sin(bearing))
        return np.stack([east, north, self("tx_z_m") + hoist * later_s], axis=-1)

    @property
    def tops(self) -> Floats:
        """Where masts' antennas are, as it is written down [n, 3]."""
        return MASTS_M[self.mast]

    def apart(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return np.asarray(np.linalg.norm(self.booms(later_s) - self.tops, axis=-1) - self.away)

    def met(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([1.0 if kind in row else 0.0 for row in self.table["obstacles"]])
