"""The atrium: wells of its lifts, galleries of its robots, what nobody knows of these, and rows.

numpy and pandas alone. Cars of glass ride up and down a hotel's court from rest to rest, robots
carry linen and trays over its floor and its galleries; units on balconies and below the roof
range them, in rounds that come a little sooner or later.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]
COURT_M = (24.0, 17.0, 16.4)
STOREY_M, STOREYS = 3.6, 4
BALCONIES_M: Floats = np.array(
    [(0.6, 3.1, 2.7), (0.6, 13.5, 9.9), (5.2, 0.5, 6.3), (12.0, 0.5, 13.4), (18.6, 0.5, 2.5),
     (23.4, 4.4, 9.8), (23.4, 12.6, 2.8), (23.4, 15.2, 13.5), (17.1, 16.5, 6.2), (9.3, 16.5, 13.3),
     (4.0, 16.5, 2.6), (12.4, 8.2, 15.9)]
)  # fmt: skip
BALCONIES = len(BALCONIES_M)
WELLS_M: Floats = np.array([(2.1, 8.6), (21.8, 7.2), (21.8, 9.9), (13.0, 15.2)])
"""Where cars go up and down, one in each well."""
CARS, ROBOTS = len(WELLS_M), 6
NAMES = (*(f"car{k}" for k in range(CARS)), *(f"robot{k}" for k in range(ROBOTS)))
ROOF_M, LID_M = 2.5, 0.9  # of tags above floors: on roofs of cars, on lids of robots
BETWEEN = {
    "glass": (0.03, 6.31, 1.2),
    "plasterboard": (0.1, 2.73, 1.7),
    "concrete": (0.1, 5.24, 4.0),
}
"""Panes of cars and parapets, partitions, planters: m, permittivity, dB of each."""
RIDE = (
    "begin_x", "begin_y", "begin_z", "way_x", "way_y", "way_z", "lasts_s", "into_s", "weave_m",
)  # fmt: skip
"""How a tag goes from rest to rest, known to nobody."""
OF_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 7.9872  # channel 9
DAY_S = 9.0 * 3600
RAIL_M = 4.88  # from joint to joint of guide rails
TOISE_M = 1.949037  # of Paris
LAWS = {
    "wax-on-covers": Law(("saturation", "logarithm", "power")),
    "cars-laden": Law(("power", "parabola")),
    "guide-rails-jointed": Law(("periodic",), RAIL_M, "m", grows=False),
    "smoke-vents-open": Law(("step",), 0.104, "m"),
    "steam-on-panes": Law(("logarithm", "power", "saturation")),
    "panes-tinted": Law(("linear", "power")),
    "fountain-plays-near": Law(("inverse", "power", "inverse square")),
    "encoder-wheel-worn": Law(),
    "snapped-to-landings": Law(),
    "balcony-rail-bent": Law(("position",), 0.46, "m", devices=("balcony3",)),
    "balconies-numbered-from-above": Law(("swap",), devices=("balcony1", "balcony6")),
    "toises-from-one-balcony": Law(
        ("unit",), 1 / TOISE_M, "1", grows=False, devices=("balcony8",)
    ),
}  # fmt: skip
"""What nobody's library has."""


class Upset(NamedTuple):
    """What upsets rows [n]: metres; dB of all that comes, of first paths, of noise, of symbols."""

    metres: Floats | float = 0.0
    whole: Floats | float = 0.0
    first: Floats | float = 0.0
    noise: Floats | float = 0.0
    symbols: Floats | float = 0.0


def cycloid(part: Floats) -> Floats:
    """Return which part of a way is gone at parts of its time [n]: no jolt at either end."""
    part = np.clip(part, 0.0, 1.0)
    return np.asarray(part - np.sin(2 * np.pi * part) / (2 * np.pi))


def whereabouts(ride: dict[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m; robots weave a little across their way."""
    gone = cycloid(into_s / ride["lasts_s"])
    begin, way = (np.stack([ride[f"{one}_{a}"] for a in "xyz"], axis=1) for one in ("begin", "way"))
    long = np.maximum(np.linalg.norm(way, axis=1), 1e-9)
    across = np.stack([-way[:, 1], way[:, 0], 0 * long], axis=1) / long[:, None]
    weave = ride["weave_m"] * np.sin(3 * np.pi * gone)
    return np.asarray(begin + gone[:, None] * way + weave[:, None] * across)


class Ride:
    """Rows of a table; `house` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, house: int, rng: np.random.Generator, seldom: bool = False
    ) -> None:
        self.table, self.house, self.rng, self.seldom = table, house, rng, seldom
        self.size = len(table)
        self.apart = self.read("true_range_m")
        self.balcony: Numbers = np.asarray(table["rx"].str.slice(7).astype(np.int64), np.int64)
        self.who: Numbers = np.asarray(table["tx"].map(NAMES.index), np.int64)
        self.link: Numbers = np.asarray(pd.factorize(table["link"])[0], np.int64)
        self.tag: Floats = np.column_stack([self.read(f"tx_{a}_m") for a in "xyz"])
        self.ear: Floats = BALCONIES_M[self.balcony]
        self.lifted: Floats = np.asarray(self.who < CARS, np.float64)

    def read(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name], np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.house, 1301, what])

    def by_link(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.link.max()) + 1), np.float64)[self.link]

    def chosen(self, share: float) -> Floats:
        """Return 1 at rows of such a share of links, else 0 [n]."""
        return self.by_link(lambda n: self.rng.random(n) < share)

    def through(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return np.array([float(kind in some) for some in self.table["obstacles"]])

    def grows_by(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow within some time, in m [n]."""
        ride = {name: self.read(name) for name in RIDE}
        then = whereabouts(ride, ride["into_s"] + later_s)
        return self.beside(then - whereabouts(ride, ride["into_s"]))

    def beside(self, tag_m: Floats, ear_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by [n, 3], in m [n]."""
        way = self.tag - self.ear
        longer = np.linalg.norm(way + tag_m - ear_m, axis=1)
        return np.asarray(longer - np.linalg.norm(way, axis=1))
