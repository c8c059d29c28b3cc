"""The brickworks: cars, traversers and grabs, what nobody knows of these, and rows of effects.

numpy and pandas alone. Rams push kiln cars, which coast to rest by an exponential. Traversers cross
at either end, sped up for half of their way and braked for the other half. Grabs slew about two
columns as a crank has them, and are hoisted meanwhile. Radios hang at the kilns' buckstays.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HALL_M = (44.0, 23.0, 8.6)  # along the kilns, across them, up to the roof's sheets
BUCKSTAYS_M: Floats = np.array(
    [(3.2, 1.1, 5.9), (12.4, 1.1, 3.3), (22.8, 1.1, 6.4), (34.1, 1.1, 4.1), (42.9, 6.8, 6.1),
     (42.9, 17.2, 3.6), (33.0, 21.9, 6.6), (20.6, 21.9, 3.0), (9.7, 21.9, 5.2), (1.1, 14.6, 3.9),
     (21.5, 11.8, 7.4)]
)  # fmt: skip
BUCKSTAYS, CARS, TRAVERSERS, GRABS = len(BUCKSTAYS_M), 4, 2, 3
TAGS = (
    *(f"car{k}" for k in range(CARS)),
    *(f"traverser{k}" for k in range(TRAVERSERS)),
    *(f"grab{k}" for k in range(GRABS)),
)
TRACKS_Y_M: Floats = np.array([4.4, 8.9, 14.3, 18.7])
COLUMNS_M: Floats = np.array([(13.5, 11.6), (30.2, 11.6)])  # that grabs slew about
BETWEEN = {
    "brick": (0.24, 0.31, 3.91, 3.4),
    "wood": (0.16, 0.22, 1.99, 1.2),
    "glass": (0.034, 0.1, 6.31, 1.7),
}
"""Stacks of ware, of pallets, panes of cabins: m, share of air, permittivity of all else, dB."""
COURSE = (
    "from_x", "from_y", "from_z", "go_x", "go_y", "go_z", "boom_m", "from_rad", "slew_rad",
    "gait", "lasts_s", "into_s",
)  # fmt: skip
"""How a tag goes, known to nobody; `gait`: of cars, traversers or grabs."""
COASTS = 2.2  # times constants in which cars come to rest
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 4.4928  # channel 3
DAY_S = 10.4 * 3600
ROD_M = 1.47  # from one tie rod of the kiln to the next
ALN_M = 0.593802  # of Sweden, until 1878
LAWS = {
    "glaze-dust-on-covers": Law(("saturation", "logarithm", "power")),
    "ware-still-wet": Law(("linear", "power")),
    "draught-bends-flues": Law(("power", "parabola")),
    "tie-rods-passed": Law(("periodic",), ROD_M, "m", grows=False),
    "damper-opened": Law(("step",), 0.109, "m"),
    "clay-press-near": Law(("inverse", "power", "inverse square")),
    "soot-on-radomes": Law(("logarithm", "power", "saturation")),
    "grabs-trail-behind": Law(),
    "kiln-bed-heaves": Law(),
    "strokes-counted-long": Law(),
    "one-buckstay-of-another-second": Law(),
    "buckstay-bent-by-heat": Law(("position",), 0.44, "m", devices=("buckstay3",)),
    "buckstays-wired-crosswise": Law(("swap",), devices=("buckstay1", "buckstay8")),
    "alnar-from-one-buckstay": Law(("unit",), 1 / ALN_M, "1", grows=False, devices=("buckstay6",)),
}
"""What nobody's library has."""


class Upshot:
    """What becomes of rows [n]: metres; dB of all that comes, of first paths, of noise, of sums."""

    def __init__(
        self,
        metres: Floats | float = 0.0,
        whole_db: Floats | float = 0.0,
        first_db: Floats | float = 0.0,
        hiss_db: Floats | float = 0.0,
        sums_db: Floats | float = 0.0,
    ) -> None:
        self.metres, self.whole_db, self.first_db = map(np.asarray, (metres, whole_db, first_db))
        self.hiss_db, self.sums_db = map(np.asarray, (hiss_db, sums_db))


def done(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return which part of a course is done [n]: by an exponential, two parabolas or a sine."""
    part = np.clip(into_s / course["lasts_s"], 0.0, 1.0)
    coasting = np.expm1(-COASTS * part) / np.expm1(-COASTS)
    braked = np.where(part < 0.5, 2 * part**2, 1 - 2 * (1 - part) ** 2)
    cranked = np.sin(0.5 * np.pi * part) ** 2
    return np.asarray(np.choose(course["gait"].astype(int), [coasting, braked, cranked]))


def carried(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m: along lines, and about columns."""
    part = done(course, into_s)
    angle = course["from_rad"] + course["slew_rad"] * part
    swung = course["boom_m"][:, None] * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    begin = np.column_stack([course[f"from_{axis}"] for axis in "xyz"])
    goes = np.column_stack([course[f"go_{axis}"] for axis in "xyz"])
    return np.asarray(begin + part[:, None] * goes + swung)


class Push:
    """Rows of a table; `stable` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, scarce: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.scarce = table, stable, rng, scarce
        self.rows = len(table)

    def get(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.get("true_range_m")

    @cached_property
    def buckstay(self) -> Integers:
        """Numbers of buckstays [n]."""
        return np.array([int(name[8:]) for name in self.table["rx"]], np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n]: cars, traversers, grabs."""
        return np.array([TAGS.index(name) for name in self.table["tx"]], np.int64)

    @cached_property
    def is_car(self) -> Floats:
        """1 at rows of cars, else 0 [n]."""
        return (self.tag < CARS).astype(np.float64)

    @cached_property
    def is_grab(self) -> Floats:
        """1 at rows of grabs, else 0 [n]."""
        return (self.tag >= CARS + TRAVERSERS).astype(np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n]."""
        return np.unique(self.table["link"].to_numpy(str), return_inverse=True)[1].astype(np.int64)

    @cached_property
    def push(self) -> Integers:
        """Numbers of pushes, from 0 on [n]."""
        told = self.table["link"].str.extract(r"push (\d+)", expand=False).astype(int)
        return np.unique(told.to_numpy(), return_inverse=True)[1].astype(np.int64)

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def hung(self) -> Floats:
        """Where radios are said to hang [n, 3], in m."""
        return np.asarray(BUCKSTAYS_M[self.buckstay])

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self.get(name) for name in COURSE}

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1601, what])

    def each_link(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.link.max()) + 1), np.float64)[self.link]

    def each_push(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for pushes, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.push.max()) + 1), np.float64)[self.push]

    def behind(self, share: float) -> Floats:
        """Return 1 at such a share of all links, of those without line of sight, else 0 [n]."""
        first = np.unique(self.link, return_index=True)[1]
        unseen = np.flatnonzero(~self.table["los"].to_numpy(bool)[first])
        wanted = min(max(round(share * len(first)), 1), len(unseen))
        chosen = self.rng.permutation(unseen)[:wanted]
        return np.isin(self.link, chosen).astype(np.float64)

    def meets(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return self.table["obstacles"].map(lambda things: kind in things).to_numpy(np.float64)

    def further(self, tag_m: Floats | float, radio_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by [n, 3], in m [n]."""
        said = self.there - self.hung
        true = said + tag_m - radio_m
        return np.asarray(np.sqrt((true**2).sum(axis=1)) - np.sqrt((said**2).sum(axis=1)))

    def moved(self, later_s: Floats | float) -> Floats:
        """Return how tags have moved some time later, in m [n, 3]."""
        into_s = self.course["into_s"]
        return np.asarray(carried(self.course, into_s + later_s) - carried(self.course, into_s))

    def further_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.further(self.moved(later_s))
