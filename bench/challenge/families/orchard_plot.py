"""The orchard: where posts and tanks are, what nobody knows of it, and rows that effects read.

numpy and pandas alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
GROUND_M = (46.0, 30.0)
POSTS_M = np.array(
    [(0.0, 0.0, 2.9), (22.0, -1.0, 3.6), (46.0, 1.0, 2.5), (47.0, 29.0, 3.3), (24.0, 31.0, 2.7),
     (-1.0, 28.0, 3.8), (12.0, 14.7, 3.1), (35.0, 15.1, 2.3)]
)  # fmt: skip
TANKS_M = np.array(
    [(5.0, 36.0, 2.0), (40.0, -7.0, 1.5), (54.0, 18.0, 2.5), (-8.0, 11.0, 1.8), (23.0, 40.0, 3.0)]
)  # of water, that reflect
PICKERS = 4
STACKS = {"wood": (0.12, 2.6), "plywood": (0.09, 2.1), "brick": (0.21, 6.5)}  # late in m, dB
COURSE = ("pace_m_per_s", "weave_m", "weave_rad_per_s", "weave_rad")
ANSWER_S = 0.0021  # the second reply of a double-sided exchange, by firmware
QUARTER_LIGHT = 74.9481145  # metres per ppm and second
CARRIER_M = 0.0858  # 3.4944 GHz
YARD_M = 0.9144
LAWS = {
    "dew-on-leaves": Law(("saturation", "logarithm", "power")),
    "crates-aboard": Law(("power", "parabola")),
    "irrigation-turns": Law(("periodic",), 1370.0, "s", grows=False),
    "sprayer-runs": Law(("step",), 0.15, "m"),
    "few-satellites": Law(("inverse", "power", "inverse square")),
    "leaves-grow": Law(("linear", "power")),
    "slope-forgotten": Law(),
    "slew-limited": Law(),
    "heights-from-the-soil": Law(),
    "post-leans": Law(("position",), 0.558, "m", devices=("post7",)),
    "posts-relabelled": Law(("swap",), devices=("post1", "post3")),
    "yards-from-one-post": Law(("unit",), 1 / YARD_M, "1", grows=False, devices=("post5",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Yield:
    """What rows yield [n]: metres; decibels of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Plot:
    """Rows of a table; `season` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    season: int
    rng: np.random.Generator
    seldom: bool = False
    _columns: dict[str, Floats] = field(default_factory=dict)

    def __call__(self, column: str) -> Floats:
        """Return a column [n]."""
        if column not in self._columns:
            self._columns[column] = self.table[column].to_numpy(np.float64)
        return self._columns[column]

    @property
    def distance(self) -> Floats:
        """True distances in m [n]."""
        return self("true_range_m")

    @property
    def post(self) -> NDArray[np.intp]:
        """Numbers of the posts [n]."""
        return np.array([int(name[-1]) for name in self.table["rx"]], np.intp)

    @property
    def picker(self) -> NDArray[np.intp]:
        """Numbers of the pickers [n]."""
        return np.array([int(name[-1]) for name in self.table["tx"]], np.intp)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.season, what, 713])

    def each_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        place, links = pd.factorize(self.table["link"])
        return np.asarray(made(len(links)), np.float64)[place]

    def picker_at(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where the pickers are some time later, on their weaving courses [n, 3]."""
        pace, weave, rate, phase = (self(name) for name in COURSE)
        sways = weave * (np.sin(phase + rate * later_s) - np.sin(phase))
        return np.stack(
            [self("tx_x_m") + pace * later_s, self("tx_y_m") + sways, self("tx_z_m")], axis=1
        )

    def gap(self, pickers: Floats, posts: Floats | None = None) -> Floats:
        """Return distances between pickers and posts [n, 3], theirs unless given, in m [n]."""
        return np.asarray(
            np.linalg.norm(pickers - (POSTS_M[self.post] if posts is None else posts), axis=1)
        )

    def behind(self, *kinds: str) -> Floats:
        """Return 1 for rows with one of some kinds in the straight path, else 0 [n]."""
        return np.array([not {*kinds}.isdisjoint(row) for row in self.table["obstacles"]]) * 1.0
