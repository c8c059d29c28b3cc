"""The swimming hall: basin, beacons, what nobody knows of it, and rows that effects read.

numpy and pandas alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
HALL_M = (38.0, 22.0, 8.5)
BASIN_M = (6.0, 25.0)  # where lanes begin, and how long they are
LANES_M = 4.5 + 2.1 * np.arange(6)
BEACONS_M = np.array(
    [(1.0, 2.0, 2.4), (19.0, 0.5, 3.1), (37.0, 1.5, 2.2), (37.5, 20.0, 4.6), (18.0, 21.5, 2.8),
     (0.5, 19.0, 5.3), (11.0, 10.5, 7.9), (27.0, 11.5, 7.4), (37.5, 10.8, 1.9)]
)  # fmt: skip
SWIMMERS = 5
SLABS = {"glass": (0.05, 2.5, 2.2), "concrete": (0.14, 2.3, 7.5), "wood": (0.09, 1.5, 1.8)}
"""What screens and pillars are made of: thickness in m, index of refraction, loss in dB."""
COURSE = ("along_m", "pace_m_per_s", "surge_m", "surge_rad_per_s", "surge_rad")
HALF_LIGHT = 149.896229  # metres per ppm and second
CARRIER_M = 0.0751  # 3.9936 GHz
FOOT_M = 0.3048
LAWS = {
    "cap-fills": Law(("saturation", "logarithm", "power")),
    "splashing": Law(("linear", "power")),
    "wave-machine": Law(("periodic",), 610.0, "s", grows=False),
    "pump-starts": Law(("step",), 0.14, "m"),
    "salted-water": Law(("parabola", "power")),
    "bathers-around": Law(("logarithm", "power", "saturation")),
    "water-let-out": Law(),
    "laps-smoothed": Law(),
    "crossed-wires": Law(),
    "beacon-on-loose-pole": Law(("position",), 0.505, "m", devices=("beacon3",)),
    "beacons-mixed-up": Law(("swap",), devices=("beacon2", "beacon4")),
    "feet-from-one-beacon": Law(("unit",), 1 / FOOT_M, "1", grows=False, devices=("beacon1",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Change:
    """What rows change by [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


def in_the_lane(along_m: Floats) -> Floats:
    """Return the x in m of swimmers that turn at both ends [n]; `along_m` counts on and on."""
    begin, length = BASIN_M
    return np.asarray(begin + length - np.abs(np.mod(along_m, 2 * length) - length))


@dataclass(frozen=True)
class Swims:
    """Rows of a table; `meet` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    meet: int
    rng: np.random.Generator
    seldom: bool = False

    def __call__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    @property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self("true_range_m")

    def number(self, end: str) -> NDArray[np.intp]:
        """Return the numbers of devices at an end, tx or rx [n]."""
        return self.table[end].str.extract(r"(\d+)$")[0].to_numpy(np.intp)

    def hung(self) -> Floats:
        """Return where the beacons are, as they are written down [n, 3]."""
        return BEACONS_M[self.number("rx")]

    def kept(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([733, what, self.meet])

    def by_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        which, links = pd.factorize(self.table["link"])
        return np.asarray(made(len(links)), np.float64)[which]

    def swum(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where swimmers are some time later [n, 3]."""
        along, pace, surge, rate, phase = (self(name) for name in COURSE)
        there = in_the_lane(along + pace * later_s + surge * np.sin(phase + rate * later_s))
        return np.stack([there, self("tx_y_m"), self("tx_z_m")], axis=1)

    def reach(self, later_s: Floats | float = 0.0, beacons: Floats | None = None) -> Floats:
        """Return distances to beacons some time later, theirs unless given, in m [n]."""
        ends = self.hung() if beacons is None else beacons
        return np.asarray(np.linalg.norm(self.swum(later_s) - ends, axis=1))

    def behind(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([1.0 if kind in row else 0.0 for row in self.table["obstacles"]])
