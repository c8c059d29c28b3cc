"""The ice rink: skaters, penguins, resurfacers and pairs on its ice, and rows of these.

numpy and pandas alone. Mullions of the glass and of the stands have radios, and so have two below
the roof. Skaters glide on one edge, whose lean stays while air slows them; penguins, which learners
hold on to, are pushed off, rub, and rebound off boards; resurfacers drive laps along the boards,
round corners; in pairs one turns about the other ever closer, and turns the faster for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HALL_M = (74.0, 44.0, 13.0)
AMID_M, HALF_M, CORNER_M = (37.0, 22.0), (30.0, 15.0), 8.5  # of the ice: middle, half sides, round
PER_PPM_MS_M = 0.149896229  # metres for each millisecond of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 2
DAY_S = 11.0 * 3600
PANE_M = 1.22  # from one pane of the glass to the next
WARM_BRINE_C = -8.6  # over which the compressor runs
LOKET_M = 0.5927  # of Bohemia
MULLIONS_M: Floats = np.array(
    [(4.5, 12.0, 3.2), (5.0, 31.5, 4.8), (16.0, 4.0, 2.7), (30.5, 3.2, 5.4), (45.0, 4.4, 3.6),
     (60.5, 3.6, 4.3), (69.6, 14.5, 2.9), (68.9, 30.0, 5.1), (57.0, 40.2, 3.3), (40.5, 40.8, 6.0),
     (22.0, 39.9, 4.1), (25.0, 22.0, 11.2), (49.0, 23.0, 11.6)]
)  # fmt: skip
"""Where mullions have their radios, in m [MULLIONS, 3]; the last two are below the roof."""
MULLIONS, BELOW_ROOF = len(MULLIONS_M), (11, 12)
CUBE_M: Floats = np.array(
    [(37.0 + x, 22.0 + y, z) for x in (-1.8, 1.8) for y in (-1.8, 1.8) for z in (7.0, 9.5)]
)
"""Corners of the scoreboard above the ice, in m [8, 3]."""
SORTS = {"skater": 4, "penguin": 3, "resurfacer": 2, "pair": 3}
"""How many tags there are of each sort."""
TAGS = tuple(f"{sort}{k}" for sort, count in SORTS.items() for k in range(count))
PLACES = {"skater": "open ice", "penguin": "end zone", "resurfacer": "boards", "pair": "centre"}
COURSE = ("sort", "east", "north", "tall", "heads", "pace", "bends", "slows", "spans", "goes",
          "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `gone_to`."""
LAWS = {
    "frost-grows-on-mullions": Law(("saturation", "logarithm", "power")),
    "slush-heaps-on-boards": Law(("power", "parabola")),
    "scoreboard-let-down-close-by": Law(("inverse", "power", "inverse square")),
    "film-spreads-since-flooded": Law(("logarithm", "power", "saturation")),
    "carbon-sticks-in-the-rack": Law(("linear", "power")),
    "panes-pass-alongside": Law(("periodic",), PANE_M, "m", grows=False),
    "compressor-runs-on-warm-brine": Law(("step",), 0.096, "m"),
    "air-dews-above-ice": Law(),
    "skaters-lean-in-more-than-told": Law(),
    "penguins-rub-on-wet-ice": Law(),
    "resurfacers-lap-further-in": Law(),
    "pairs-hold-gives-as-they-turn": Law(),
    "truss-sags-under-snow": Law(),
    "tripod-melts-into-the-ice": Law(),
    "answers-sent-twice": Law(),
    "mullion-bent-by-a-check": Law(("position",), 0.48, "m", devices=("mullion10",)),
    "mullions-patched-to-each-others-ports": Law(("swap",), devices=("mullion1", "mullion8")),
    "lokte-from-one-mullion": Law(("unit",), 1 / LOKET_M, "1", grows=False, devices=("mullion9",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Marks:
    """What rows [n] get: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def off_boards(x: Floats, y: Floats) -> Floats:
    """Return how far places on the ice are from its boards in m [...]; < 0 behind these."""
    over = [np.abs(at - mid) - half + CORNER_M for at, mid, half in zip((x, y), AMID_M, HALF_M,
                                                                        strict=True)]  # fmt: skip
    out = np.hypot(np.maximum(over[0], 0.0), np.maximum(over[1], 0.0))
    return np.asarray(CORNER_M - out - np.minimum(np.maximum(*over), 0.0))


def glided(course: Course, gone_s: Floats) -> tuple[Floats, Floats]:
    """Return how far skaters have come, east and north in m, [n] each.

    Air slows them by the square of their speed, so that 1 / v grows evenly; who leans as before
    then turns by g tan / v, ever faster. By 16 of Gauss's places.
    """
    at, by = np.polynomial.legendre.leggauss(16)
    when = 0.5 * gone_s[:, None] * (at + 1)
    slows = course["slows"].clip(0.1)[:, None]
    turn = course["heads"][:, None] + course["bends"][:, None] * (when + when**2 / (2 * slows))
    way = 0.5 * gone_s[:, None] * by * course["pace"][:, None] / (1 + when / slows)
    return (way * np.cos(turn)).sum(axis=1), (way * np.sin(turn)).sum(axis=1)


def _skater(course: Course, gone_s: Floats) -> Floats:
    """Return where skaters are, who rise and sink a little, in m [n, 3]."""
    east, north = glided(course, gone_s)
    up = course["tall"] + course["spans"] * np.sin(4.6 * gone_s + course["heads"])
    return np.stack([course["east"] + east, course["north"] + north, up], axis=1)


def slid_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far penguins have slid, which rub evenly until they stand, in m [n]."""
    while_s = np.minimum(gone_s, course["pace"] / course["slows"])
    return np.asarray(course["pace"] * while_s - 0.5 * course["slows"] * while_s**2)


def rebounded(at: Floats, low: float, high: float) -> Floats:
    """Return where things are between two boards that would be at places without these [n]."""
    return np.asarray(high - np.abs(np.mod(at - low, 2 * (high - low)) - (high - low)))


def at_rebound(course: Course, slid: Floats) -> Floats:
    """Return where penguins are that have slid so far, in m [n, 3]."""
    there = [course["tall"]]
    for k, way in ((1, np.sin), (0, np.cos)):
        low, high = AMID_M[k] - HALF_M[k] + 0.6, AMID_M[k] + HALF_M[k] - 0.6
        start = course["north"] if k else course["east"]
        there.insert(0, rebounded(start + slid * way(course["heads"]), low, high))
    return np.stack(there, axis=1)


def _penguin(course: Course, gone_s: Floats) -> Floats:
    return at_rebound(course, slid_m(course, gone_s))


def on_lap(course: Course, gone_s: Floats, in_m: float = 0.0) -> Floats:
    """Return where resurfacers are, in m [n, 3]: four straights, and four quarters of circles.

    `in_m`: by how much they are further in than is said.
    """
    radius, long = CORNER_M - course["spans"], [2 * (half - CORNER_M) for half in HALF_M]
    arc = 0.5 * np.pi * radius
    round_m = np.mod(course["east"] + course["pace"] * gone_s, 2 * sum(long) + 4 * arc)
    x, y = np.zeros(len(arc)), np.zeros(len(arc))
    begin = np.zeros(len(arc))
    for side in range(4):
        straight, turn = long[side % 2], 0.5 * np.pi * side
        on = (round_m - begin).clip(0.0, straight)
        bent = (round_m - begin - straight) / arc
        here = (round_m >= begin) & (bent < 1)
        angle = bent.clip(0.0, 1.0) * 0.5 * np.pi
        less = radius - in_m
        along = on - 0.5 * straight + less * np.sin(angle)
        out = 0.5 * long[1 - side % 2] + less * np.cos(angle)
        x = np.where(here, along * np.cos(turn) + out * np.sin(turn), x)
        y = np.where(here, along * np.sin(turn) - out * np.cos(turn), y)
        begin = begin + straight + arc
    return np.stack([AMID_M[0] + x, AMID_M[1] + y, course["tall"]], axis=1)


def _resurfacer(course: Course, gone_s: Floats) -> Floats:
    return on_lap(course, gone_s)


def in_hold(course: Course, gone_s: Floats, gives: Floats | float = 0.0) -> Floats:
    """Return where who turns about a partner is, in m [n, 3]: drawn in, by what spin is kept.

    The turn is the integral of one over the square of how far out. `gives`: of how far out, the
    part by which arms give at a radian a second, by the square of that.
    """
    left = 1 - gone_s / course["slows"]
    turn = course["heads"] + course["pace"] * gone_s / left
    out = course["spans"] * left * (1 + gives * (course["pace"] / left**2) ** 2)
    x, y = course["east"] + out * np.cos(turn), course["north"] + out * np.sin(turn)
    return np.stack([x, y, course["tall"]], axis=1)


def _pair(course: Course, gone_s: Floats) -> Floats:
    return in_hold(course, gone_s)


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_skater, _penguin, _resurfacer, _pair)
"""Of sorts as in SORTS."""


def gone_to(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * into_s
    there = np.zeros((len(gone_s), 3))
    for number, way in enumerate(WAYS):
        own = course["sort"] == number
        if own.any():
            there[own] = way({name: course[name][own] for name in COURSE}, gone_s[own])
    return there


class Period:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `mullion`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.mullion: Integers = table["rx"].str.slice(len("mullion")).to_numpy().astype(np.int64)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3603, what])

    def each_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def ends(self) -> tuple[Floats, Floats]:
        """Where tags and mullions' radios are said to be, in m [n, 3] each."""
        both = (self.table[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64)
                for end in ("tx", "rx"))  # fmt: skip
        return next(both), next(both)

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    @cached_property
    def gone_s(self) -> Floats:
        """How long tags have gone, 0 of those that do not, in s [n]."""
        return self.course["goes"] * self.course["into_s"]

    def are(self, sort: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a sort [n]."""
        return np.asarray(self.table["tx"].str.startswith(sort), np.bool_)

    def through(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]], np.float64)

    def screened(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        some = np.unique(self.link[self.table["obstacles"].str.len().gt(0).to_numpy()])
        count = min(max(1, round(share * (int(self.link.max()) + 1))), len(some))
        return np.isin(self.link, self.rng.permutation(some)[:count]).astype(np.float64)

    def stretched(self, tag_m: Floats | float, mullion_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.ends[1] - self.ends[0]
        moved = way + np.asarray(mullion_m) - np.asarray(tag_m)
        return np.asarray(np.linalg.norm(moved, axis=1) - np.linalg.norm(way, axis=1))

    def skates_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.stretched(gone_to(self.course, now_s + later_s) - gone_to(self.course, now_s))
