"""The opera: cleats, bars and wagons of a stage, what nobody knows of these, and rows of effects.

numpy and pandas alone. Bars fly up and down on winches; wagons ride round on the revolve, or roll
aside. All go from rest to rest by a cam's course. Radios hang at cleats of galleries and portals.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
STAGE_M = (28.0, 21.0, 27.0)  # across, from the curtain to the back wall, up to the grid
CLEATS_M: Floats = np.array(
    [(0.8, 3.5, 8.2), (0.8, 10.2, 13.5), (0.8, 17.0, 8.2), (0.8, 6.4, 19.0), (27.2, 4.1, 13.5),
     (27.2, 9.5, 8.2), (27.2, 16.3, 19.0), (27.2, 13.0, 13.5), (6.5, 20.4, 10.4),
     (19.0, 20.4, 5.1), (5.8, 0.9, 3.1), (22.3, 0.9, 4.6)]
)  # fmt: skip
CLEATS, BARS, WAGONS = len(CLEATS_M), 5, 4
ON_GALLERIES = 8  # cleats, the first ones
TAGS = (*(f"bar{k}" for k in range(BARS)), *(f"wagon{k}" for k in range(WAGONS)))
BARS_Y_M: Floats = np.array([3.3, 6.1, 9.0, 12.2, 15.7])
REVOLVE_M: Floats = np.array([14.0, 10.5])  # its middle
BETWEEN = {
    "plywood": (0.12, 0.55, 2.71, 1.1),
    "chipboard": (0.17, 0.7, 2.58, 2.4),
    "concrete": (0.14, 0.93, 5.24, 5.2),
}
"""Packs of flats, rostra, parapets: m, how much of it is solid, permittivity of that, dB."""
COURSE = (
    "from_x", "from_y", "from_z", "go_x", "go_y", "go_z", "arm_m", "from_rad", "turn_rad",
    "lasts_s", "into_s",
)  # fmt: skip
"""How a tag goes, known to nobody."""
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 4
DAY_S = 9.2 * 3600
CASTOR_M = 1.31  # from one castor of the revolve to the next
VARA_M = 0.8359  # of Castile
LAWS = {
    "haze-on-radomes": Law(("logarithm", "power", "saturation")),
    "bars-ballasted": Law(("power", "parabola")),
    "revolve-castors-passed": Law(("periodic",), CASTOR_M, "m", grows=False),
    "iron-curtain-lowered": Law(("step",), 0.114, "m"),
    "velour-takes-up-damp": Law(("linear", "power")),
    "follow-spot-near": Law(("inverse", "power", "inverse square")),
    "rosin-settles": Law(("saturation", "logarithm", "power")),
    "bars-sag-between-lines": Law(),
    "revolve-slips": Law(),
    "rake-forgotten": Law(),
    "one-cleat-of-another-clock": Law(),
    "cleat-caught-by-a-flat": Law(("position",), 0.43, "m", devices=("cleat1",)),
    "cleats-of-two-sides-mistaken": Law(("swap",), devices=("cleat0", "cleat7")),
    "varas-from-one-cleat": Law(("unit",), 1 / VARA_M, "1", grows=False, devices=("cleat5",)),
}
"""What nobody's library has."""


class Change(NamedTuple):
    """What becomes of rows [n]: metres; dB of all that comes, of first paths, of noise, of sums."""

    metres: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    hiss_db: Floats | float = 0.0
    sums_db: Floats | float = 0.0


def done(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return which part of a course is done [n]: a cycloid, which begins and ends at rest."""
    part = np.clip(into_s / course["lasts_s"], 0.0, 1.0)
    return np.asarray(part - np.sin(2 * np.pi * part) / (2 * np.pi))


def carried(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m: along a line, and round the revolve's middle."""
    part = done(course, into_s)
    turned = course["from_rad"] + course["turn_rad"] * part
    arm = course["arm_m"]
    round_m = np.stack([arm * np.cos(turned), arm * np.sin(turned), 0 * arm], axis=1)
    begin, goes = (
        np.stack([course[f"{one}_{axis}"] for axis in "xyz"], axis=1) for one in ("from", "go")
    )
    return np.asarray(begin + goes * part[:, None] + round_m)


class Cue:
    """Rows of a table; `stable` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, seldom: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.seldom = table, stable, rng, seldom
        self.count = len(table)

    def column(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name].to_numpy(), np.float64)

    @cached_property
    def way(self) -> Floats:
        """True distances in m [n]."""
        return self.column("true_range_m")

    @cached_property
    def cleat(self) -> Integers:
        """Numbers of cleats [n]."""
        return np.asarray([int(name[5:]) for name in self.table["rx"]], np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n]: bars first."""
        return np.asarray([TAGS.index(name) for name in self.table["tx"]], np.int64)

    @cached_property
    def flown(self) -> Floats:
        """1 at rows of bars, 0 at those of wagons [n]."""
        return np.where(self.tag < BARS, 1.0, 0.0)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n]."""
        return np.unique(self.table["link"], return_inverse=True)[1].astype(np.int64)

    @cached_property
    def number(self) -> Integers:
        """Numbers of cues, from 0 on [n]."""
        said = self.table["link"].str.extract(r"cue (\d+)")[0]
        return np.unique(said, return_inverse=True)[1].astype(np.int64)

    @cached_property
    def at(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return np.stack([self.column(f"tx_{axis}_m") for axis in "xyz"], axis=1)

    @cached_property
    def post(self) -> Floats:
        """Where cleats are said to be [n, 3], in m."""
        return np.asarray(CLEATS_M[self.cleat])

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self.column(name) for name in COURSE}

    @cached_property
    def hidden(self) -> Floats:
        """1 at rows without line of sight, else 0 [n]."""
        return np.where(self.table["los"].to_numpy(bool), 0.0, 1.0)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1501, what])

    def by_link(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.link.max()) + 1), np.float64)[self.link]

    def by_cue(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for cues, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.number.max()) + 1), np.float64)[self.number]

    def some_hidden(self, share: float) -> Floats:
        """Return 1 at such a share of all links, all of them without line of sight, else 0 [n]."""
        lot = np.zeros(int(self.link.max()) + 1)
        lot[self.link] = self.hidden
        lot = lot + self.rng.random(len(lot))
        least = np.sort(lot)[-max(round(share * len(lot)), 1)]
        return np.where((lot >= max(least, 1.0))[self.link], 1.0, 0.0)

    def through(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return np.array([float(kind in things) for things in self.table["obstacles"]])

    def longer_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        into_s = self.course["into_s"]
        return self.longer(carried(self.course, into_s + later_s) - carried(self.course, into_s))

    def longer(self, tag_m: Floats | float, cleat_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by [n, 3], in m [n]."""
        apart = self.at - self.post
        return np.asarray(
            np.linalg.norm(apart + tag_m - cleat_m, axis=1) - np.linalg.norm(apart, axis=1)
        )
