"""The cathedral: censers, vergers, doves, pilgrims, masons and choristers, and rows of these.

numpy and pandas alone. A nave and a transept cross; bosses on piers, walls and vaults have radios,
which answer tags. Censers swing across from the crossing's vault, vergers go up and down with a
halting step, doves fly rings and figures of eight, pilgrims go to and fro along rings of a
labyrinth, masons are hoisted along walls, choristers go about an oblong that is nearly one.
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
Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]
ROOM_M = (38.0, 26.0, 15.0)
NAVE_M, CROSS_M = ((0.0, 38.0), (7.0, 19.0)), ((22.0, 30.0), (0.0, 26.0))
"""From where to where these go, along and across."""
MIDDLE_M: Floats = np.array([26.0, 13.0, 0.0])
"""Of the floor below the crossing."""
FEAST_S = 6.4 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 3.9936  # channel 2
BOSSES_M: Floats = np.array([
    [1.0, 12.4, 6.5], [4.2, 7.5, 2.6], [4.6, 18.5, 5.0], [10.3, 7.4, 6.8],
    [11.2, 18.4, 2.2], [16.1, 7.5, 3.0], [17.3, 18.5, 8.2], [22.4, 7.3, 4.4],
    [29.6, 18.7, 3.4], [26.4, 0.6, 7.5], [24.3, 25.5, 2.4], [28.7, 25.3, 5.6],
    [33.2, 7.5, 2.3], [36.9, 13.8, 8.8], [33.7, 18.4, 6.0], [25.6, 13.3, 14.1],
])  # fmt: skip
BOSSES = len(BOSSES_M)
KINDS = {"censer": 2, "verger": 3, "dove": 2, "pilgrim": 3, "mason": 2, "chorister": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"censer": "crossing", "verger": "nave", "dove": "vault", "pilgrim": "nave",
          "mason": "scaffold", "chorister": "choir"}  # fmt: skip
COURSE = ("gait", "mid_x", "mid_y", "lift", "reach", "broad", "tempo", "turn", "goes", "into_s")
"""How a tag goes, known to nobody; see `borne`."""
FLAG_M = 0.62  # of the floor's stones, from joint to joint
SLACK_MM = 58.0  # of wind, at which the blower runs
PASSUS_M = 1.4789
FALL = 9.80665
HALTS, BEAT = 0.55, 1.9  # of a step's pace, taken off and put on; by so many radians a second
SWAY_M, SWAYS = 0.25, 0.8  # of a mason's cradle; radians a second
LAWS = {
    "wax-gutters-over-covers": Law(("saturation", "logarithm", "power")),
    "incense-thickens-about-tags": Law(("power", "logarithm", "saturation")),
    "candlestands-drawn-close": Law(("inverse", "inverse square", "power")),
    "hassocks-heaped-before-bosses": Law(("linear", "power")),
    "pipes-cool-since-stoked": Law(("logarithm", "power", "saturation")),
    "damp-rises-behind-bosses": Law(("parabola", "power")),
    "joints-of-flags-pass-underfoot": Law(("periodic",), FLAG_M, "m", grows=False),
    "blower-runs-at-slack-wind": Law(("step",), 0.096, "m"),
    "candles-warm-ways-that-pass-them": Law(),
    "thuribles-swing-wider-than-told": Law(),
    "vergers-halt-for-longer": Law(),
    "doves-sink-as-they-glide": Law(),
    "labyrinth-laid-oval": Law(),
    "winch-drum-fills-as-it-winds": Law(),
    "processions-cut-their-corners": Law(),
    "clock-of-places-set-right-each-quarter": Law(),
    "tower-leans-off-its-plumb": Law(),
    "cross-drawn-askew": Law(),
    "heights-told-in-whole-courses-of-stone": Law(),
    "places-told-as-middles-of-flags": Law(),
    "answers-kept-until-they-differ-enough": Law(),
    "longer-of-two-answers-told": Law(),
    "answers-no-longer-than-a-chain": Law(),
    "boss-pushed-in-by-a-scaffold": Law(("position",), 0.52, "m", devices=("boss5",)),
    "bosses-lettered-crosswise": Law(("swap",), devices=("boss2", "boss12")),
    "passus-from-one-boss": Law(("unit",), 1 / PASSUS_M, "1", grows=False, devices=("boss6",)),
}
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Dues:
    """What rows [n] owe: `late_m` of range; dB of levels, first paths, noise and counts."""

    late_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    summed_db: Floats | float = 0.0


def clear_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from walls, floor or vaults, in m [n]; < 0 outside."""
    aisles = []
    for box in (NAVE_M, CROSS_M):
        off = [np.minimum(at[:, k] - low, high - at[:, k]) for k, (low, high) in enumerate(box)]
        aisles.append(np.minimum(*off))
    level = np.minimum(at[:, 2], ROOM_M[2] - 0.4 - at[:, 2])
    return np.asarray(np.minimum(np.maximum(*aisles), level))


def swings(course: Course, gone_s: Floats, wider: float = 0.0) -> Floats:
    """Return where censers are, in m [n, 3]: on ropes `reach` long, by angles up to `broad`.

    The wider, by so much the slower (Bernoulli 1747).
    """
    most = course["broad"] * (1 + wider)
    pace = np.sqrt(FALL / course["reach"]) * (1 - course["broad"] ** 2 / 16)
    angle = most * np.sin(course["tempo"] + pace * gone_s)
    aside = course["reach"] * np.sin(angle)
    return np.column_stack([course["mid_x"] + aside * np.cos(course["turn"]),
                            course["mid_y"] + aside * np.sin(course["turn"]),
                            course["lift"] - course["reach"] * np.cos(angle)])  # fmt: skip


def paces(course: Course, gone_s: Floats, halts: float = 0.0) -> Floats:
    """Return where vergers are, in m [n, 3]: each step comes to a halt, for longer by a part."""
    step = np.sin(BEAT * gone_s + course["turn"]) - np.sin(course["turn"])
    along = course["tempo"] * (1 - halts) * (gone_s - HALTS / BEAT * step)
    return np.column_stack([course["mid_x"] + along, course["mid_y"], course["lift"]])


def soars(course: Course, gone_s: Floats, sinks: float = 0.0) -> Floats:
    """Return where doves are, in m [n, 3]: rings that go up and down; they sink by m/s."""
    angle = course["turn"] + course["tempo"] * gone_s
    up = 0.8 * np.sin(2 * angle + 0.6) - sinks * gone_s
    return np.column_stack([course["mid_x"] + course["reach"] * np.cos(angle),
                            course["mid_y"] + course["broad"] * np.sin(angle),
                            course["lift"] + up])  # fmt: skip


def treads(course: Course, gone_s: Floats, oval: float = 0.0) -> Floats:
    """Return where pilgrims are, in m [n, 3]: to and fro on rings, which are oval by a part."""
    angle = course["turn"] + course["broad"] * np.sin(course["tempo"] * gone_s / course["broad"])
    return np.column_stack([course["mid_x"] + course["reach"] * np.cos(angle) * (1 - oval),
                            course["mid_y"] + course["reach"] * np.sin(angle) * (1 + oval),
                            course["lift"]])  # fmt: skip


def hoists(course: Course, gone_s: Floats, fills: float = 0.0) -> Floats:
    """Return where masons are, in m [n, 3]: up or down walls, as the drum fills the faster."""
    sway = SWAY_M * np.sin(SWAYS * gone_s + course["turn"])
    high = course["lift"] + course["tempo"] * gone_s * (1 + fills * gone_s)
    return np.column_stack([course["mid_x"] + sway, course["mid_y"], high])


def files(course: Course, gone_s: Floats, cut: float = 0.0) -> Floats:
    """Return where choristers are, in m [n, 3]: about an oblong, whose corners are cut by a part.

    All of these cut leave an ellipse.
    """
    square = 0.1 * (1 - cut)
    angle = course["turn"] + course["tempo"] * gone_s
    east = (1 + square) * np.cos(angle) - square * np.cos(3 * angle)
    north = (1 + square) * np.sin(angle) + square * np.sin(3 * angle)
    return np.column_stack([course["mid_x"] + course["reach"] * east,
                            course["mid_y"] + course["broad"] * north, course["lift"]])  # fmt: skip


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (swings, paces, soars, treads, hoists, files)
"""Of kinds as in KINDS."""


def borne(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = (course["goes"] * into_s).clip(0.0)
    there = np.zeros((len(gone_s), 3))
    for kind, way in enumerate(WAYS):
        own = np.flatnonzero(course["gait"] == kind)
        if len(own):
            there[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return there


class Vigil:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `boss`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        numbers = {tag: k for k, tag in enumerate(TAGS)}
        self.tag: Integers = np.array([numbers[one] for one in table["tx"]], np.int64)
        self.boss: Integers = np.array([int(one[4:]) for one in table["rx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([5403, self.case, what])

    def each(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def boss_m(self) -> Floats:
        """Where bosses are said to be, in m [n, 3]."""
        return np.column_stack([self[f"rx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return np.column_stack([self[f"tx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, kind: str) -> Bools:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.bool_)

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([1.0 if what in some else 0.0 for some in self.table["obstacles"]])

    def shut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        hidden = self.table["obstacles"].map(bool).to_numpy(np.bool_)
        could = np.unique(self.link[hidden])
        count = min(max(round(share * (int(self.link.max()) + 1)), 1), len(could))
        return np.isin(self.link, self.rng.permutation(could)[:count]).astype(np.float64)

    def longer_m(self, tag_off: Floats | float, boss_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        run = self.boss_m - self.tag_m
        now = np.linalg.norm(run + boss_off - tag_off, axis=1)
        return np.asarray(now - np.linalg.norm(run, axis=1))

    def strays_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.longer_m(borne(self.course, now_s + later_s) - borne(self.course, now_s))
