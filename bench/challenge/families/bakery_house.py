"""The bakery's house: hoods over ovens and tables, what nobody knows of it, rows that effects read.

numpy and pandas alone. One long room: fronts of steel of deck ovens along a wall, tables and
provers across from them, a floor of tiles, on which bakers push racks from here to there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
HOUSE_M = (15.0, 38.0, 5.2)
HOODS_M = np.array(
    [(1.4, 2.3, 2.7), (13.2, 4.6, 3.9), (7.1, 10.9, 4.8), (1.2, 16.8, 3.2), (13.6, 20.2, 2.9),
     (6.6, 25.4, 4.4), (1.5, 31.1, 2.5), (12.9, 36.2, 3.6)]
)  # fmt: skip
RACKS = 7
CABINETS_M = np.array([(0.5, 9.0), (0.5, 26.5)])  # of the ovens' igniters
PARTS = {"plasterboard": (0.15, 2.73, 2.2), "glass": (0.028, 6.31, 1.8), "wood": (0.16, 1.99, 2.9)}
"""Walls of provers, panes before the shop, pallets of flour: m, permittivity, dB of each."""
TILES = 6.5  # permittivity
PUSH = ("heading_rad", "pace_m_per_s", "turn_rad_per_s")
PER_PPM_S = 0.5 * 299.792458  # metres per ppm and second of a reply
WAVE_M = 0.299792458 / 6.4896  # channel 5
ELL_M = 0.66694  # the Prussian one
NIGHT_S = 6.5 * 3600
BURN_S = 410.0  # from one firing of the burners to the next
SHELF_M = 0.22
LAWS = {
    "flour-settles": Law(("saturation", "logarithm", "power")),
    "prover-steams": Law(("power", "parabola")),
    "burners-cycle": Law(("periodic",), BURN_S, "s", grows=False),
    "shutter-rolled-up": Law(("step",), 0.124, "m"),
    "fat-on-hoods": Law(("logarithm", "power", "saturation")),
    "dough-rises": Law(("linear", "power")),
    "fan-belts-slip": Law(("inverse", "power", "inverse square")),
    "tag-a-shelf-away": Law(),
    "ranges-smoothed-slowly": Law(),
    "hood-knocked": Law(("position",), 0.525, "m", devices=("hood6",)),
    "hoods-miswritten": Law(("swap",), devices=("hood1", "hood4")),
    "ells-from-one-hood": Law(("unit",), 1 / ELL_M, "1", grows=False, devices=("hood3",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Bake:
    """What becomes of rows [n]: metres; dB of the whole, of the front, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    front: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


def arc(pace: Floats, turn: Floats, heading: Floats, since_s: Floats | float) -> Floats:
    """Return how far racks get in so many s on arcs [n, 3], in m: a chord each."""
    half = 0.5 * turn * since_s
    chord = pace * since_s * np.sinc(half / np.pi)
    way = (np.cos(heading + half), np.sin(heading + half), 0 * half)
    return np.asarray(chord[:, None] * np.stack(way, axis=1))


class Sheet:
    """Rows of a table; `night` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, night: int, rng: np.random.Generator, few: bool = False
    ) -> None:
        self.table, self.night, self.rng, self.few = table, night, rng, few
        self.rows = len(table)
        self.far = self.get("true_range_m")
        self.hood = table["rx"].str.slice(4).astype(int).to_numpy(np.intp)
        self.rack = table["tx"].str.slice(4).astype(int).to_numpy(np.intp)
        self._links, self._number = np.unique(table["link"].to_numpy(str), return_inverse=True)

    def get(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.array(self.table[name], np.float64)

    def constant(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, 922, self.night])

    def of_links(self, make: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        return np.asarray(make(len(self._links)), np.float64)[self._number]

    def hooks(self) -> Floats:
        """Return where hoods have their antennas, as is written down [n, 3], in m."""
        return HOODS_M[self.hood]

    def tags(self, after_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later, on the arcs that they are pushed [n, 3], in m."""
        heading, pace, turn = (self.get(name) for name in PUSH)
        here = np.stack([self.get(f"tx_{axis}_m") for axis in "xyz"], axis=1)
        return here + arc(pace, turn, heading, after_s)

    def grown(self, after_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.grown_from(self.tags(after_s))

    def grown_from(self, tags_m: Floats) -> Floats:
        """Return by how much ways from tags at [n, 3] are longer, in m [n]."""
        return np.asarray(np.linalg.norm(tags_m - self.hooks(), axis=1) - self.far)

    def behind(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([float(kind in some) for some in self.table["obstacles"]])

    def in_turn(self, step: Callable[[int, float, float], float]) -> Floats:
        """Return ranges [n], each made by `step` of its row, itself and the one made before it.

        Of a link's first row, and where its time begins anew, the range itself.
        """
        ranges, time = self.get("range_m"), self.get("time_s")
        made, last = ranges.copy(), dict[int, int]()
        for row, link in enumerate(self._number.tolist()):
            before = last.get(link)
            if before is not None and time[row] > time[before]:
                made[row] = step(row, float(ranges[row]), float(made[before]))
            last[link] = row
        return made
