"""The brewery: gantries over a cellar of tanks, what nobody knows of it, and rows effects read.

numpy and pandas alone. Upright tanks of steel in two rows, aisles with drains between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
WIDE_M, LONG_M = 22.0, 38.0
GANTRIES_M = np.array(
    [(1.2, 2.0, 3.1), (11.0, 0.8, 4.6), (20.6, 5.5, 3.7), (21.1, 19.0, 4.9),
     (20.3, 33.5, 3.3), (10.4, 37.1, 5.1), (1.6, 31.0, 4.2), (0.7, 16.4, 3.5)]
)  # fmt: skip
BARROWS = 4
FILLED = {"plywood": (0.16, 2.71, 3.4), "brick": (0.12, 3.91, 5.0), "glass": (0.06, 6.31, 3.6)}
"""Crates, a wall of services, bottles: thickness in m, permittivity, loss in dB."""
PUSH = ("aisle_rad", "pace_m_per_s", "gains_m_per_s2")
HALF_PPM_M = 0.5 * 299.792458  # metres per ppm and second of a reply
GHZ = 7.9872  # channel 9
WAVE_M = 0.299792458 / GHZ
ELL_M = 0.8330  # the Bavarian one
HANDLE_M = 0.42  # from a barrow's middle to its handle
DAY_S = 8.0 * 3600
LAWS = {
    "foam-on-tags": Law(("power", "parabola")),
    "glycol-pump-cycles": Law(("periodic",), 540.0, "s", grows=False),
    "steam-let-in": Law(("step",), 0.13, "m"),
    "malt-dust-settles": Law(("saturation", "logarithm", "power")),
    "kegs-stacked": Law(("logarithm", "power", "saturation")),
    "tank-fills": Law(("linear", "power")),
    "supply-starved": Law(("inverse", "power", "inverse square")),
    "tag-on-the-handle": Law(),
    "median-of-last-three": Law(),
    "gantry-knocked": Law(("position",), 0.54, "m", devices=("gantry6",)),
    "gantries-miscalled": Law(("swap",), devices=("gantry1", "gantry4")),
    "ells-from-one-gantry": Law(("unit",), 1 / ELL_M, "1", grows=False, devices=("gantry3",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Brew:
    """What is added to rows [n]: metres; dB of the whole, the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


class Batch:
    """Rows of a table; `vat` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, vat: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.vat, self.rng, self.rare = table, vat, rng, rare
        self.rows = len(table)
        self.m = self.get("true_range_m")
        self.gantry = np.array([int(one[6:]) for one in table["rx"]], np.intp)
        self.barrow = np.array([int(one[6:]) for one in table["tx"]], np.intp)
        self.hung = GANTRIES_M[self.gantry]

    def get(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.array(self.table[name], dtype=np.float64)

    def recipe(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.vat, 871, what])

    def links(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        names, back = np.unique(self.table["link"].to_numpy(str), return_inverse=True)
        return np.asarray(made(names.size), np.float64)[back.reshape(-1)]

    def tags(self, after_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later: along aisles, slower or faster [n, 3], in m."""
        aisle, pace, gains = (self.get(name) for name in PUSH)
        gone = pace * after_s + 0.5 * gains * np.square(after_s)
        here = np.column_stack([self.get(f"tx_{axis}_m") for axis in "xyz"])
        return here + gone[:, None] * _along(aisle)

    def beside(self, tags_m: Floats) -> Floats:
        """Return by how much ways from tags at [n, 3] are longer, in m [n]."""
        return np.asarray(np.sqrt(((tags_m - self.hung) ** 2).sum(axis=1)) - self.m)

    def farther(self, after_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.beside(self.tags(after_s))

    def stands(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return self.table["obstacles"].apply(lambda row: float(kind in row)).to_numpy(np.float64)


def _along(aisle_rad: Floats) -> Floats:
    """Return directions of aisles [n, 3]."""
    return np.column_stack([np.cos(aisle_rad), np.sin(aisle_rad), np.zeros(len(aisle_rad))])


def handles(batch: Batch, far_m: float) -> Floats:
    """Return where handles of barrows are, so far behind their middles [n, 3], in m."""
    return batch.tags() - far_m * _along(batch.get("aisle_rad"))
