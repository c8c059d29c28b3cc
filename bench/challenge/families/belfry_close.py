"""The close about a belfry: gargoyles high and low, what nobody knows of it, rows effects read.

numpy and pandas alone. A tower that stands by itself in a walled churchyard: mowers go about its
grass, steeplejacks hang on ropes before its faces, and headstones stand here and there.
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
CLOSE_M = (44.0, 40.0)
TOWER_M, HALF_M = (22.0, 20.0), 3.5
GARGOYLES_M = np.array(
    [(18.4, 16.4, 9.2), (25.6, 16.3, 15.1), (25.7, 23.6, 21.4), (18.3, 23.7, 27.3),
     (1.2, 3.1, 2.7), (42.3, 5.8, 3.5), (40.6, 37.4, 2.2), (3.4, 36.6, 4.3)]
)  # fmt: skip
HEADSTONES_M = np.array(
    [(6.0, 9.5), (11.5, 5.0), (33.0, 8.0), (38.5, 14.0), (36.0, 29.5), (29.0, 35.5), (13.0, 33.0),
     (7.5, 25.0)]
)  # fmt: skip
MASONS = 7
SCREENS = {"wood": (0.11, 1.99, 2.3), "brick": (0.15, 3.91, 4.6), "glass": (0.045, 6.31, 2.4)}
"""Lych gates and louvres, buttresses and walls, leaded panes: m, permittivity, dB of each."""
WATER = 80.0  # permittivity
GOING = ("course_rad", "climb_rad", "speed_m_per_s", "gain_m_per_s2")
LIGHT_HALF = 149.896229  # metres per ppm and second of a reply
LENGTH_M = 299.792458 / 4492.8  # of waves of channel 3
TOISE_M = 1.949
DAY_S = 9.5 * 3600
QUARTER_S = 900.0  # from one stroke of the clock to the next
LAWS = {
    "lichen-on-radomes": Law(("saturation", "logarithm", "power")),
    "dew-gathers": Law(("power", "parabola")),
    "quarters-struck": Law(("periodic",), QUARTER_S, "s", grows=False),
    "louvres-shut": Law(("step",), 0.136, "m"),
    "moss-grows": Law(("logarithm", "power", "saturation")),
    "nests-grow": Law(("linear", "power")),
    "brackets-sag": Law(("inverse", "power", "inverse square")),
    "barometer-drifts": Law(),
    "leaps-cut": Law(),
    "gargoyle-broken-off": Law(("position",), 0.535, "m", devices=("gargoyle5",)),
    "gargoyles-misread": Law(("swap",), devices=("gargoyle1", "gargoyle6")),
    "toises-from-one-gargoyle": Law(
        ("unit",), 1 / TOISE_M, "1", grows=False, devices=("gargoyle2",)
    ),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Toll:
    """What is added to rows [n]: metres; dB of all, of what is first, of hiss, of the count."""

    metres: Floats
    all: Floats | float = 0.0
    first: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


def ahead(course: Floats, climb: Floats) -> Floats:
    """Return directions [n, 3] of courses and climbs in radians."""
    level = np.cos(climb)
    return np.stack([level * np.cos(course), level * np.sin(course), np.sin(climb)], axis=-1)


@dataclass(frozen=True)
class Watch:
    """Rows of a table; `day` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    day: int
    rng: np.random.Generator
    seldom: bool = False

    def __len__(self) -> int:
        """Return how many rows there are."""
        return len(self.table)

    def __getitem__(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(dtype=np.float64, copy=True)

    @cached_property
    def away(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def gargoyle(self) -> NDArray[np.intp]:
        """Numbers of gargoyles [n]."""
        return np.array([int(one.replace("gargoyle", "")) for one in self.table["rx"]], np.intp)

    @cached_property
    def mason(self) -> NDArray[np.intp]:
        """Numbers of masons [n]."""
        return np.array([int(one.replace("mason", "")) for one in self.table["tx"]], np.intp)

    @cached_property
    def link(self) -> NDArray[np.intp]:
        """Numbers of links in order of their first rows [n]."""
        return np.asarray(pd.factorize(self.table["link"])[0], np.intp)

    def stays(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, self.day, 942])

    def linked(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        return np.asarray(made(self.link.max() + 1), np.float64)[self.link]

    def mouths(self) -> Floats:
        """Return where gargoyles have their antennas, as is written down [n, 3], in m."""
        return GARGOYLES_M[self.gargoyle]

    def tags(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later, faster or slower by then [n, 3], in m."""
        course, climb, speed, gain = (self[name] for name in GOING)
        gone = later_s * (speed + 0.5 * gain * later_s)
        here = self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)
        return np.asarray(here + gone[:, None] * ahead(course, climb))

    def opened(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.opened_from(self.tags(later_s))

    def opened_from(self, tags_m: Floats) -> Floats:
        """Return by how much ways from tags at [n, 3] are longer, in m [n]."""
        off = self.mouths() - tags_m
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", off, off)) - self.away)

    def screened(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.asarray([1.0 if kind in some else 0.0 for some in self.table["obstacles"]])

    def after_another(self) -> NDArray[np.intp]:
        """Return for rows [n] which is the one before of the same link and visit, or -1."""
        seen, time, out = dict[int, int](), self["time_s"], np.full(len(self), -1, np.intp)
        for row, link in enumerate(self.link.tolist()):
            before = seen.get(link, -1)
            out[row] = before if before >= 0 and time[before] < time[row] else -1
            seen[link] = row
        return out
