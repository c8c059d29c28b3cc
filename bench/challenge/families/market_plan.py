"""The supermarket: lamps and shelves, what nobody knows of it, and rows that effects read.

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
FLOOR_M = (33.0, 22.0)
AISLES_M = 3.0 + 3.3 * np.arange(9)  # x of their middles; shelves stand between them
SHELVES_M = AISLES_M[:-1] + 1.65
ENDS_M = (3.2, 18.8)  # y of the ends of shelves
LAMPS_M = np.array(
    [(1.5, 1.0, 3.9), (16.0, 0.5, 3.4), (32.0, 1.2, 4.1), (31.5, 21.0, 3.2), (15.0, 21.5, 4.0),
     (0.8, 20.5, 2.7), (8.2, 10.4, 4.2), (24.8, 11.6, 3.7)]
)  # fmt: skip
TROLLEYS = 6
GOODS = {"brick": (0.13, 5.0), "chipboard": (0.05, 1.9), "plasterboard": (0.08, 2.8)}
"""What stands in the way, as a pillar, a shelf or a wall: late in m, loss in dB."""
WALK = ("walked_m", "walk_m_per_s", "halts_rad_per_s", "halts_rad")
HALF_LIGHT = 149.896229  # metres per ppm and second
LIGHT = 0.299792458  # metres per nanosecond
CARRIER_GHZ = 7.9872
TICK_M = 0.0046917  # which a firmware takes for 5 mm
LAWS = {
    "trolley-load": Law(("linear", "power")),
    "fridges-run": Law(("periodic",), 870.0, "s", grows=False),
    "tills-open": Law(("step",), 0.13, "m"),
    "cell-runs-down": Law(("inverse", "power", "inverse square")),
    "shoppers-crowd": Law(("saturation", "logarithm", "power")),
    "wax-on-floor": Law(("power", "parabola")),
    "plan-stretched": Law(),
    "plan-turned": Law(),
    "old-ranges-kept": Law(),
    "lamp-on-new-hook": Law(("position",), 0.533, "m", devices=("lamp6",)),
    "lamps-interchanged": Law(("swap",), devices=("lamp0", "lamp4")),
    "ticks-for-millimetres": Law(("unit",), 0.005 / TICK_M, "1", grows=False, devices=("lamp2",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Bill:
    """What rows are billed [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


def on_the_floor(walked_m: Floats) -> Floats:
    """Return the y in m of who turns at both walls [n]; `walked_m` counts on and on."""
    width = FLOOR_M[1] - 2.0
    return np.asarray(1.0 + np.abs(np.mod(walked_m + width, 2 * width) - width))


@dataclass(frozen=True)
class Goods:
    """Rows of a table; `week` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    week: int
    rng: np.random.Generator
    seldom: bool = False

    def of(self, column: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[column], np.float64)

    def far(self) -> Floats:
        """Return true distances in m [n]."""
        return self.of("true_range_m")

    def which(self, end: str) -> NDArray[np.intp]:
        """Return the numbers of devices at an end, tx or rx [n]."""
        return np.array([int(name[-1]) for name in self.table[end]], np.intp)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng((self.week, 752, what))

    def per_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        links, place = np.unique(self.table["link"].to_numpy(str), return_inverse=True)
        return np.asarray(made(len(links)), np.float64)[place]

    def trolleys(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where trolleys are some time later, as they halt and go on [n, 3]."""
        walked, speed, halts, phase = (self.of(name) for name in WALK)
        sway = (np.sin(phase + halts * later_s) - np.sin(phase)) / halts
        there = on_the_floor(walked + speed * (later_s - sway))
        return np.stack([self.of("tx_x_m"), there, self.of("tx_z_m")], axis=1)

    def lamps(self) -> Floats:
        """Return where lamps are, as they are written down [n, 3]."""
        return LAMPS_M[self.which("rx")]

    def apart(self, later_s: Floats | float) -> Floats:
        """Return distances some time later in m [n]."""
        return np.asarray(np.linalg.norm(self.trolleys(later_s) - self.lamps(), axis=1))

    def hidden_by(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([float(kind in row) for row in self.table["obstacles"]])
