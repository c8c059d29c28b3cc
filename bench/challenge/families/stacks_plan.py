"""The archive: readers and mobile shelves, what nobody knows of it, and rows that effects read.

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
ROOM_M = (27.0, 15.0, 3.4)
CORRIDOR_M = 7.5  # y of its middle; shelves stand in a block on either side of it
CARRIAGE_M = 0.86
READERS_M = np.array(
    [(0.3, 0.4, 2.9), (13.2, 0.3, 2.2), (26.7, 0.6, 3.1), (26.6, 14.5, 2.5), (12.5, 14.7, 3.0),
     (0.4, 14.4, 2.0), (13.5, 7.6, 3.35)]
)  # fmt: skip
CARTS = 5
SLABS = {"chipboard": (0.11, 2.58, 2.7), "concrete": (0.085, 5.24, 6.8), "wood": (0.14, 1.99, 2.1)}
"""What stands in the way, as a shelf, a pillar, a cabinet: thickness in m, permittivity, dB."""
GAIT = ("pace_m_per_s", "sway_m", "sway_rad_per_s", "sway_rad")
HALF_LIGHT = 149.896229  # metres per ppm and second
LIGHT = 0.299792458  # metres per nanosecond
CARRIER_GHZ = 7.9872  # channel 9
LAWS = {
    "paper-swells": Law(("power", "parabola")),
    "boxes-returned": Law(("saturation", "logarithm", "power")),
    "air-handler": Law(("periodic",), 790.0, "s", grows=False),
    "reading-lights": Law(("step",), 0.13, "m"),
    "dust-settles": Law(("logarithm", "power", "saturation")),
    "rails-laden": Law(("linear", "power")),
    "ceiling-sags": Law(),
    "carriage-moved": Law(),
    "clocks-step": Law(),
    "reader-slid-down": Law(("position",), 0.5259, "m", devices=("reader3",)),
    "readers-interchanged": Law(("swap",), devices=("reader0", "reader4")),
    "half-metres-from-one-reader": Law(
        ("unit",), 2.0, "1", grows=False, devices=("reader1",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Entry:
    """What is entered for rows [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Files:
    """Rows of a table; `volume` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    volume: int
    rng: np.random.Generator
    seldom: bool = False

    def __getitem__(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name], np.float64)

    def __len__(self) -> int:
        return len(self.table)

    def far(self) -> Floats:
        """Return true distances in m [n]."""
        return self["true_range_m"]

    def reader(self) -> NDArray[np.intp]:
        """Return numbers of readers [n]."""
        names = self.table["rx"].str.removeprefix("reader")
        return np.asarray(names.to_numpy(str), np.intp)

    def cart(self) -> NDArray[np.intp]:
        """Return numbers of carts [n]."""
        names = self.table["tx"].str.removeprefix("cart")
        return np.asarray(names.to_numpy(str), np.intp)

    def bound(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([792, self.volume, what])

    def linkwise(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        links = pd.Categorical(self.table["link"])
        return np.asarray(np.asarray(made(len(links.categories)), np.float64)[links.codes])

    def walkers(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where carts are some time later, as they are pushed along and sway [n, 3]."""
        pace, sway, rate, phase = (self[name] for name in GAIT)
        aside = sway * (np.sin(phase + rate * later_s) - np.sin(phase))
        here = np.stack([self[f"tx_{axis}_m"] for axis in "xyz"], axis=1)
        return np.asarray(here + np.stack([aside, pace * later_s, 0 * pace], axis=1))

    def hung(self) -> Floats:
        """Return where readers are, as they are written down [n, 3]."""
        return READERS_M[self.reader()]

    def later(self, later_s: Floats | float) -> Floats:
        """Return by how much distances grow in some time, in m [n]."""
        apart = self.walkers(later_s) - self.hung()
        return np.asarray(np.sqrt(np.square(apart).sum(axis=1)) - self.far())

    def crosses(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.fromiter((kind in row for row in self.table["obstacles"]), np.float64, len(self))
