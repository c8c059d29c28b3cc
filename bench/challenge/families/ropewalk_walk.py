"""The ropewalk: spinners, sledges, tops, bobbins and trucks of a long hall, and rows of these.

numpy and pandas alone. Struts along the hall have radios, which call; tags answer. Spinners walk
backwards and weave past trestles, by a sine of their way; sledges are drawn in as strands are
twisted, by what a helix is shorter than its strand; tops run along a rope, whose tags turn with
the lay; bobbins go round with a disc, and their cradles against it; trucks are wound from rest to
rest, as a cycloid's cam has it.
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
HALL_M = (88.0, 8.4, 6.8)
HALF_LIGHT_M = 149.896229  # that light makes in a microsecond, of which the way there is half
WAVE_M = 0.299792458 / 3.4944  # channel 1
SHIFT_S = 8.6 * 3600
TRESTLE_M = 1.37  # from one trestle to the next
LOW_STEAM_BAR = 3.9  # under which the engine's belt drives nothing else
ZHANG_M = 10 / 3
STRUTS_M: Floats = np.array(
    [(1.2, 4.0, 5.2), (7.5, 0.6, 2.4), (13.0, 7.8, 4.6), (20.5, 0.5, 3.9), (26.0, 7.9, 2.1),
     (33.5, 4.3, 6.3), (38.0, 0.6, 4.9), (45.5, 7.8, 3.2), (51.0, 0.5, 2.2), (57.5, 7.9, 5.1),
     (63.0, 4.1, 6.2), (69.0, 0.6, 3.5), (74.5, 7.8, 2.6), (81.0, 0.5, 4.7), (86.8, 4.4, 3.0)]
)  # fmt: skip
"""Where struts have their radios, in m [STRUTS, 3]."""
STRUTS, NORTH, ANNEXE = len(STRUTS_M), (2, 4, 7, 9, 12), (11, 12, 13, 14)
IRON_M: Floats = np.array([(9.0, 1.6, 1.9), (47.0, 6.6, 2.2), (77.0, 2.0, 1.6)])
"""Where the tar copper, the engine and the capstan stand, in m: middles of their iron."""
KINDS = {"spinner": 3, "sledge": 2, "top": 2, "bobbin": 2, "truck": 2}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"spinner": "spinning ground", "sledge": "laying ground", "top": "laying ground",
          "bobbin": "machine floor", "truck": "store"}  # fmt: skip
COURSE = ("kind", "east", "north", "up", "heads", "pace", "size", "turn", "goes", "into_s")
"""How a tag goes, known to nobody; see `come_to`."""
LAY_M = 3.6  # of a rope, in which a top's tag turns once
CRADLE, REACH = -2.0, 0.35  # turns of a cradle, each of the disc; its arm, next to the disc's
LAWS = {
    "tar-clings-to-covers": Law(("saturation", "logarithm", "power")),
    "twist-stiffens-strands-over-tags": Law(("power", "parabola")),
    "copper-swung-close-by": Law(("inverse", "power", "inverse square")),
    "oakum-bales-stacked-before": Law(("linear", "power")),
    "oil-creeps-since-hemp-was-dressed": Law(("logarithm", "power", "saturation")),
    "trestles-pass-underneath": Law(("periodic",), TRESTLE_M, "m", grows=False),
    "belt-thrown-off-at-low-steam": Law(("step",), 0.102, "m"),
    "hemp-dust-hangs-by-the-hackles": Law(),
    "yarn-taken-up-as-it-twists": Law(),
    "strands-harden-and-draw-sledges-sooner": Law(),
    "rope-laid-longer-than-told": Law(),
    "cradles-geared-by-another-wheel": Law(),
    "places-looked-up-at-nearest-beats": Law(),
    "walls-bow-out-under-snow": Law(),
    "annexe-rebuilt-askew-since-the-survey": Law(),
    "north-row-taped-from-the-outer-face": Law(),
    "answers-booked-to-who-answers-next": Law(),
    "strut-shoved-by-a-bale-truck": Law(("position",), 0.53, "m", devices=("strut6",)),
    "struts-chalked-with-each-others-numbers": Law(("swap",), devices=("strut3", "strut9")),
    "zhang-from-one-strut": Law(
        ("unit",), 1 / ZHANG_M, "1", grows=False, devices=("strut11",)
    ),
}  # fmt: skip
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Due:
    """What rows [n] owe: `late_m` of range; dB of all, first paths, noise and counts."""

    late_m: Floats | float = 0.0
    dim_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    hiss_db: Floats | float = 0.0
    tally_db: Floats | float = 0.0


def within_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from the nearest side of the hall, in m [n]; < 0 outside."""
    sides = np.minimum(at, np.array(HALL_M) - at)
    return np.asarray(sides.min(axis=1))


def _placed(course: Course, along: Floats, aside: Floats, over: Floats) -> Floats:
    """Return places so far along and aside of where courses begin, and so high, in m [n, 3]."""
    heads = course["heads"]
    return np.column_stack([course["east"] + heads * along, course["north"] + heads * aside, over])


def spun(course: Course, gone_s: Floats, takes: float = 0.0) -> Floats:
    """Return where spinners are, in m [n, 3]: `turn` m to a weave, `size` m to either side.

    `takes`: what yarn is shorter by for each m of it that was spun before.
    """
    way = course["pace"] * gone_s
    aside = course["size"] * np.sin(2 * np.pi * way / course["turn"])
    return _placed(course, way - 0.5 * takes * way**2, aside, course["up"] + 0 * way)


def drawn_in(course: Course, gone_s: Floats, harder: float = 0.0) -> Floats:
    """Return where sledges are, in m [n, 3], by strands of `size` m that wind about each other.

    A strand's turns lie at `pace` m each second, and did for `turn` s before; `harder` by a part.
    """
    wound = course["pace"] * (course["turn"] + np.stack([gone_s * (1 + harder), 0 * gone_s]))
    left = np.sqrt(course["size"] ** 2 - wound**2)
    return _placed(course, left[1] - left[0], 0 * gone_s, course["up"] + 0 * gone_s)


def laid(course: Course, gone_s: Floats, longer: float = 0.0) -> Floats:
    """Return where tops' tags are, in m [n, 3], on helices; the lay is longer by a part."""
    way = course["pace"] * gone_s
    turn = course["turn"] + 2 * np.pi * way / (LAY_M * (1 + longer))
    arm = course["size"]
    return _placed(course, way, arm * np.cos(turn), course["up"] + arm * np.sin(turn))


def wheeled(course: Course, gone_s: Floats, more: float = 0.0) -> Floats:
    """Return where bobbins are, in m [n, 3]: `pace` is the disc's, in radians each second.

    Cradles turn `more` times as often against it.
    """
    turned = course["pace"] * gone_s
    disc, cradle = course["turn"] + turned, course["turn"] + CRADLE * (1 + more) * turned
    aside, over = (course["size"] * (of(disc) + REACH * of(cradle)) for of in (np.cos, np.sin))
    return _placed(course, 0 * turned, aside, course["up"] + over)


def wound_up(course: Course, gone_s: Floats) -> Floats:
    """Return where trucks are, in m [n, 3]: `size` m on after `turn` s, from rest to rest."""
    part = 2 * np.pi * (gone_s / course["turn"]).clip(0.0, 1.0)
    way = course["size"] / (2 * np.pi) * (part - np.sin(part))
    return _placed(course, way, 0 * way, course["up"] + 0 * way)


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (spun, drawn_in, laid, wheeled, wound_up)
"""Of kinds as in KINDS."""


def come_to(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * into_s
    there = np.empty((len(gone_s), 3))
    for kind, way in enumerate(WAYS):
        own = course["kind"] == kind
        if own.any():
            there[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return there


class Hank:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `strut`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        struts = table["tx"].str.removeprefix("strut")
        self.strut: Integers = np.asarray(struts, np.str_).astype(np.int64)
        numbers = {tag: k for k, tag in enumerate(TAGS)}
        self.tag: Integers = np.asarray(table["rx"].map(numbers)).astype(np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([4103, what, self.case])

    def by_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return draws(int(self.link.max()) + 1).astype(np.float64)[self.link]

    def _places(self, end: str) -> Floats:
        return self.table[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def strut_m(self) -> Floats:
        """Where struts' radios are said to be, in m [n, 3]."""
        return self._places("tx")

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self._places("rx")

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.course["kind"] == list(KINDS).index(kind))

    def at(self, some: tuple[int, ...]) -> Floats:
        """Return 1 at rows of some struts, else 0 [n]."""
        return np.isin(self.strut, some).astype(np.float64)

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def shut_out(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        first = np.unique(self.link, return_index=True)[1]
        could = np.flatnonzero([bool(self.table["obstacles"].iloc[row]) for row in first])
        count = min(max(round(share * len(first)), 1), len(could))
        return np.isin(self.link, self.rng.permutation(could)[:count]).astype(np.float64)

    def more_m(self, strut_off: Floats | float, tag_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        run = self.tag_m - self.strut_m
        longer = np.linalg.norm(run + tag_off - strut_off, axis=1) - np.linalg.norm(run, axis=1)
        return np.asarray(longer)

    def pays_out(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.more_m(0.0, come_to(self.course, now_s + later_s) - come_to(self.course, now_s))
