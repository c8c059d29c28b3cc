"""The watermill: wheel, sacks, millers, drift, carts and buckets, and rows of these.

numpy and pandas alone. Three storeys of oak stand beside a wheel house over the race; hatches,
radios at fixed places, hear tags. Paddles go round with the wheel; sacks are drawn up by a belt
that takes up its slack, and sway; millers walk round stones on rounded squares (Lame 1818); drift
slows down towards a screen; carts turn by spirals that keep their angle (Bernoulli 1692); buckets
go up and down on a belt about two pulleys.
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
ROOM_M = (28.0, 18.0, 12.5)
STOREYS_M = (0.0, 4.1, 8.2)
"""Heights of floors, of which those above ground are of oak."""
WALL_M, ARCH_M = 20.0, 9.0
"""Across, of the wall to the wheel house; along, from where it is open."""
TRAP_M: Floats = np.array([[7.0, 6.5], [13.0, 11.5]])
"""Of the hole in upper floors that sacks are drawn through, its nearest and farthest corner."""
DAY_S = 9.5 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 4.4928  # channel 3
HATCHES_M: Floats = np.array([
    [0.6, 2.4, 2.9], [0.5, 13.6, 1.8], [6.2, 17.5, 3.3], [9.4, 0.5, 2.2], [15.6, 17.4, 2.5],
    [19.4, 4.2, 3.2], [0.6, 6.8, 6.9], [4.8, 0.6, 5.6], [11.8, 17.5, 7.2], [19.5, 9.6, 6.1],
    [1.2, 16.8, 9.6], [8.6, 0.7, 10.8], [17.8, 16.4, 10.2], [20.6, 1.4, 8.8], [27.4, 3.6, 2.1],
    [27.5, 16.2, 6.4], [23.4, 17.4, 10.6],
])  # fmt: skip
HATCHES = len(HATCHES_M)
KINDS = {"paddle": 3, "sack": 3, "miller": 2, "drift": 2, "cart": 2, "bucket": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"paddle": "wheel house", "sack": "hoist", "miller": "stone floor",
          "drift": "race", "cart": "meal floor", "bucket": "elevator"}  # fmt: skip
COURSE = ("gang", "mid_x", "mid_y", "mid_z", "faces", "pace", "reach", "twist", "phase",
          "astir", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `gone_to`."""
COG_M = 0.61  # between cogs of the great spur wheel
PENSTOCK_CM = 31.0  # above which it is lifted
ELL_M = 1.143
LAWS = {
    "meal-cakes-about-hatches": Law(("saturation", "logarithm", "power")),
    "thatch-soaks-since-it-rains": Law(("logarithm", "power", "saturation")),
    "sacks-stacked-before-hatches": Law(("linear", "power")),
    "bran-settles-since-swept": Law(("power", "logarithm", "saturation")),
    "stone-crane-hung-close": Law(("inverse", "inverse square", "power")),
    "pond-presses-on-the-breast": Law(("power", "parabola")),
    "stones-tentered-too-near-or-too-far": Law(("parabola",)),
    "cogs-of-the-great-spur-pass": Law(("periodic",), COG_M, "m", grows=False),
    "penstock-lifted-past-its-stop": Law(("step",), 0.092, "m"),
    "spray-hangs-in-the-wheel-house": Law(),
    "steam-of-damp-grain-by-warmth": Law(),
    "rods-of-the-governor-have-play": Law(),
    "wheel-runs-ahead-on-its-heavy-side": Law(),
    "sacks-sway-wider-than-told": Law(),
    "millers-round-their-corners": Law(),
    "drift-drags-behind-the-stream": Law(),
    "carts-wind-in-tighter": Law(),
    "buckets-slip-with-their-belt": Law(),
    "places-foretold-straight-on": Law(),
    "floors-sag-under-full-bins": Law(),
    "mill-twists-about-its-shaft": Law(),
    "chain-a-link-short-each-length": Law(),
    "storeys-drawn-all-alike": Law(),
    "answers-late-until-charged-again": Law(),
    "notch-stuck-in-the-tally-stick": Law(),
    "slips-hung-one-nail-behind": Law(),
    "changes-of-ranges-told-by-halves": Law(),
    "sag-of-a-line-taken-off": Law(),
    "hatch-shoved-by-ice": Law(("position",), 0.49, "m", devices=("hatch9",)),
    "hatches-hung-on-each-others-hooks": Law(("swap",), devices=("hatch2", "hatch14")),
    "ells-from-one-hatch": Law(("unit",), 1 / ELL_M, "1", grows=False, devices=("hatch5",)),
}
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Due:
    """What rows [n] owe a cause: m of range, dB of levels, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def clear_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from outer walls, roof, ground and the wall to the wheel.

    In m [n]; < 0 outside.
    """
    outer = np.minimum(at, np.array(ROOM_M) - at).min(axis=1)
    return np.asarray(np.minimum(outer, np.abs(at[:, 0] - WALL_M)))


def _beside(course: Course, ahead: Floats, aside: Floats, up: Floats | float) -> Floats:
    """Return places ahead of and aside where courses face, and above, in m [n, 3]."""
    cos, sin = np.cos(course["faces"]), np.sin(course["faces"])
    east, north = ahead * cos - aside * sin, ahead * sin + aside * cos
    here = (course["mid_x"] + east, course["mid_y"] + north, course["mid_z"] + up)
    return np.stack(np.broadcast_arrays(*here), axis=1)


def goes_round(course: Course, gone_s: Floats, heavy: float = 0.0) -> Floats:
    """Return where paddles are, in m [n, 3]: `reach` from the axle, at `pace` rad/s.

    A wheel that is heavy on a side runs ahead there, by up to so many radians.
    """
    angle = course["phase"] + course["pace"] * gone_s
    angle = angle + heavy * (np.cos(angle) - np.cos(course["phase"]))
    ahead, up = course["reach"] * np.cos(angle), course["reach"] * np.sin(angle)
    return _beside(course, ahead, 0.0 * ahead, up)


def is_hoisted(course: Course, gone_s: Floats, wider: float = 0.0) -> Floats:
    """Return where sacks are, in m [n, 3]: up at `pace` once a belt of `twist` s has its slack up.

    They sway by `reach` m, wider by a part.
    """
    slack = course["twist"]
    up = course["pace"] * (gone_s + slack * np.expm1(-gone_s / slack))
    swings = np.exp(-gone_s / 7.0) * (np.sin(1.7 * gone_s + course["phase"])) - np.sin(
        course["phase"]
    )
    sways = (1 + wider) * course["reach"] * swings
    return _beside(course, sways, 0.35 * sways, up)


def walks_round(course: Course, gone_s: Floats, rounder: float = 0.0) -> Floats:
    """Return where millers are, in m [n, 3]: about stones, on a square of rounded corners (Lame).

    The power is 4, less by so much; each begins where he is told to.
    """

    def at(seconds: Floats, power: float) -> Floats:
        angle = course["phase"] + course["pace"] * seconds
        sides = np.abs(np.cos(angle)) ** power + np.abs(np.sin(angle)) ** power
        wide = course["reach"] * sides ** (-1 / power)
        return _beside(course, wide * np.cos(angle), wide * np.sin(angle), 0.0)

    power = max(4.0 - rounder, 0.75)
    return at(gone_s, power) - at(0.0 * gone_s, power) + at(0.0 * gone_s, 4.0)


def drifts(course: Course, gone_s: Floats, drags: float = 0.0) -> Floats:
    """Return where drift is, in m [n, 3]: at `pace` at first, `reach` m on at last.

    It winds by `twist` m to either side, and is a part slower if it drags.
    """
    far = course["reach"] * -np.expm1(-(1 - drags) * course["pace"] * gone_s / course["reach"])
    winds = np.sin(0.8 * far + course["phase"]) - np.sin(course["phase"])
    return _beside(course, far, course["twist"] * winds, 0.0)


def winds_out(course: Course, gone_s: Floats, tighter: float = 0.0) -> Floats:
    """Return where carts are, in m [n, 3]: on a spiral that keeps its angle, at an even pace.

    From `reach` m of its pole; out by `twist` of each metre round, by a part less if tighter.
    """
    out = course["twist"] / (1 + tighter)
    wide = course["reach"] + course["pace"] * gone_s * np.abs(out) / np.hypot(1.0, out)
    angle = course["phase"] + np.log(wide / course["reach"]) / out
    return _beside(course, wide * np.cos(angle), wide * np.sin(angle), 0.0)


def is_lifted(course: Course, gone_s: Floats, slips: float = 0.0) -> Floats:
    """Return where buckets are, in m [n, 3]: up, over a pulley, down and under another.

    Pulleys are `reach` m apart and of `twist` m radius; belts that slip go a part less far.
    """
    high, radius = course["reach"], course["twist"]
    half = high + np.pi * radius
    belt = (course["phase"] * 2 * half + (1 - slips) * course["pace"] * gone_s) % (2 * half)
    down, along = belt >= half, belt % half
    bent = ((along - high) / radius).clip(0.0)
    up = np.minimum(along, high) + radius * np.sin(bent)
    side, up = -radius * np.cos(bent), np.where(down, high - up, up)
    return _beside(course, np.where(down, -side, side), 0.0 * side, up)


GANGS = (goes_round, is_hoisted, walks_round, drifts, winds_out, is_lifted)


def gone_to(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["astir"] * into_s.clip(0.0)
    made = np.empty((len(gone_s), 3))
    for number, gang in enumerate(GANGS):
        own = course["gang"] == number
        if own.any():
            made[own] = gang({name: one[own] for name, one in course.items()}, gone_s[own])
    return made


class Grist:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `hatch`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare, self.rows = table, case, rng, rare, len(table)
        number = {name: k for k, name in enumerate(TAGS)}
        self.tag: Integers = np.asarray([number[one] for one in table["tx"]], np.int64)
        hatches = table["rx"].str.removeprefix("hatch")
        self.hatch: Integers = np.asarray(hatches, np.int64)
        links = np.unique(table["link"].to_numpy(str), return_inverse=True)[1]
        self.link: Integers = links.astype(np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([8403, self.case, what])

    def each(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(draws(self.link.max() + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return np.stack([self[f"tx_{axis}_m"] for axis in "xyz"], axis=1)

    @cached_property
    def hatch_m(self) -> Floats:
        """Where hatches are said to be, in m [n, 3]."""
        return np.stack([self[f"rx_{axis}_m"] for axis in "xyz"], axis=1)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, kind: str) -> Bools:
        """Return which rows are of tags of a kind [n]."""
        return np.array([TAGS[tag].startswith(kind) for tag in self.tag])

    def behind(self, what: str) -> Floats:
        """Return how many such things straight ways go through [n]."""
        return np.array([some.count(what) for some in map(list, self.table["obstacles"])], float)

    def shut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        hidden = np.unique(self.link[self.table["obstacles"].map(len).to_numpy() > 0])
        count = min(len(hidden), max(1, round(share * (self.link.max() + 1))))
        return np.isin(self.link, self.rng.permutation(hidden)[:count]).astype(np.float64)

    def stretched_m(self, tag_off: Floats | float, hatch_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        way = self.tag_m - self.hatch_m
        moved = np.linalg.norm(way + tag_off - hatch_off, axis=1)
        return np.asarray(moved - np.linalg.norm(way, axis=1))

    def moves_m(self, later_s: Floats | float) -> Floats:
        """Return by how much tags move some time later, in m [n, 3]."""
        now = self.course["into_s"]
        return gone_to(self.course, now + later_s) - gone_to(self.course, now)

    def creeps_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        return self.stretched_m(self.moves_m(later_s))
