"""The pottery: a works with a bottle kiln and two partitions, who goes about in it, and rows.

numpy and pandas alone. Tags call purlins. Boards are carried round ever tighter; trucks roll out;
fettlers go round benches, further out each time; paddles of pugs go by planets' wheels; saggars
are hoisted from rest; dippers go to and fro along and across, each at a pace of its own.
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
WORKS_M = (36.0, 24.0, 7.2)
KILN_M = (18.0, 11.0, 2.4)  # along, across and radius of a bottle kiln of brick
DRYING_Y, DRYING_X = 17.0, (0.0, 13.0)
"""A partition of wood before the drying room."""
GLAZE_X, GLAZE_Y = 26.0, (0.0, 12.5)
"""A partition of glass before the glaze shop."""
DAY_S = 9.5 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 3.9936  # channel 4
PURLINS_M: Floats = np.array([
    [0.5, 3.6, 3.2], [0.6, 10.4, 5.6], [0.5, 20.2, 2.8], [5.2, 0.5, 4.8], [6.4, 15.8, 6.4],
    [7.0, 23.5, 4.2], [10.8, 7.0, 6.6], [12.2, 0.6, 2.6], [13.6, 19.8, 5.0], [15.4, 23.4, 3.0],
    [18.4, 5.2, 6.2], [20.4, 0.5, 3.8], [21.8, 16.4, 5.8], [24.6, 23.5, 2.7], [25.2, 8.6, 4.4],
    [28.6, 0.6, 6.0], [29.8, 14.6, 6.7], [31.2, 23.4, 5.2], [35.5, 6.0, 3.4], [35.4, 17.2, 4.6],
])  # fmt: skip
PURLINS = len(PURLINS_M)
TRADES = {"board": 3, "truck": 3, "fettler": 3, "pug": 2, "saggar": 2, "dipper": 2}
"""How many tags there are of each trade."""
TAGS = tuple(f"{trade}{k}" for trade, count in TRADES.items() for k in range(count))
SHOPS = {"board": "throwing shop", "truck": "placing shop", "fettler": "fettling shop",
         "pug": "clay end", "saggar": "saggar house", "dipper": "dipping house"}  # fmt: skip
COURSE = ("trade", "from_x", "from_y", "from_z", "heads", "brisk", "wide", "bent", "turned",
          "stirs", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `at_trade`."""
ROLLER_M = 0.61
LID_T = 5.5  # under which a silo's lid is shut
ELL_M = 1.143
LAWS = {
    "slip-cakes-on-aerials-until-it-falls": Law(("saturation", "logarithm", "power")),
    "soot-settles-on-purlins-since-swept": Law(("logarithm", "power", "saturation")),
    "glaze-runs-down-over-tags": Law(("linear", "power")),
    "weak-draught-lets-smoke-linger": Law(("inverse", "power", "inverse square")),
    "rack-truck-parked-beside": Law(("inverse square", "inverse", "power")),
    "elements-load-the-mains": Law(("power", "parabola")),
    "shop-off-its-usual-damp": Law(("parabola",)),
    "rollers-of-the-biscuit-way-pass": Law(("periodic",), ROLLER_M, "m", grows=False),
    "lid-of-the-clay-silo-shuts": Law(("step",), 0.088, "m"),
    "flint-dust-hangs-in-the-glaze-shop": Law(),
    "kiln-warms-ways-that-pass-it": Law(),
    "wet-ware-steams-by-warmth": Law(),
    "slip-main-fills-and-empties": Law(),
    "heat-of-firings-stays-in-walls": Law(),
    "boards-turned-tighter-than-told": Law(),
    "trucks-roll-on-on-oiled-axles": Law(),
    "fettlers-step-further-out-each-round": Law(),
    "paddles-geared-by-another-pinion": Law(),
    "saggars-slip-on-a-greasy-rope": Law(),
    "dippers-reach-further-across": Law(),
    "tags-told-where-their-bearers-walk": Law(),
    "plan-photographed-by-a-bulging-lens": Law(),
    "heights-levelled-from-a-falling-floor": Law(),
    "kiln-shoulders-purlins-aside": Law(),
    "tags-ride-up-on-stacked-boards": Law(),
    "beams-creep-down-through-the-day": Law(),
    "answers-slow-after-each-meal": Law(),
    "answers-filed-shortest-first": Law(),
    "answers-drawn-to-their-links-mean": Law(),
    "loudest-answer-of-a-round-drags-the-rest": Law(),
    "folding-rule-gives-at-each-joint": Law(),
    "worn-end-of-the-rule": Law(),
    "purlin-knocked-by-a-falling-saggar": Law(("position",), 0.42, "m", devices=("purlin10",)),
    "purlins-chalked-for-each-other": Law(("swap",), devices=("purlin4", "purlin12")),
    "ells-from-one-purlin": Law(("unit",), 1 / ELL_M, "1", grows=False, devices=("purlin6",)),
}  # fmt: skip
"""What nobody's library has."""
Course = dict[str, Floats]
PLANET, FROM_REST_S, ACROSS = 3.3, 1.4, 1.5
"""Turns of paddles' wheels to one of theirs; of hoists; paces of dippers across to one along."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


@dataclass(frozen=True)
class Toll:
    """What rows [n] pay: m of range, dB of levels, of first paths, of noise, of counts."""

    more_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def room_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from walls, floor, roof and kiln in m [n]; < 0 beyond."""
    sides = np.minimum(at, np.array(WORKS_M) - at).min(axis=1)
    return np.asarray(np.minimum(sides, kiln_m(at)))


def kiln_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from the kiln's outside in m [n]."""
    return np.asarray(np.hypot(at[:, 0] - KILN_M[0], at[:, 1] - KILN_M[1]) - KILN_M[2])


def _laid(course: Course, ahead: Floats, aside: Floats, up: Floats | float = 0.0) -> Floats:
    """Return places so far ahead, aside and up of where courses begin, in m [n, 3]."""
    plane = (ahead + 1j * aside) * np.exp(1j * course["heads"])
    begun = np.column_stack([course["from_x"], course["from_y"], course["from_z"]])
    return np.asarray(begun + np.column_stack([plane.real, plane.imag, up + 0.0 * ahead]))


def carried(course: Course, gone_s: Floats, tighter: float = 0.0) -> Floats:
    """Return where boards are, in m [n, 3]: round as the square of the way gone (Euler)."""
    way = course["brisk"] * gone_s
    part = 0.5 * (NODES[:, None] + 1) * way
    turns = np.exp(0.5j * course["bent"] * (1 + tighter) * part**2)
    off = 0.5 * way * (WEIGHTS @ turns)
    return _laid(course, off.real, off.imag)


def rolled(course: Course, gone_s: Floats, longer: float = 0.0) -> Floats:
    """Return where trucks are, in m [n, 3]: ever slower by what holds them back."""
    rests_s = course["wide"] * (1 + longer)
    return _laid(course, -course["brisk"] * rests_s * np.expm1(-gone_s / rests_s), 0.0 * gone_s)


def spiralled(course: Course, gone_s: Floats, out: float = 0.0) -> Floats:
    """Return where fettlers are, in m [n, 3]: round, so many m further out each radian."""
    gone = course["brisk"] * gone_s
    arm = course["wide"] + (course["bent"] + out) * gone
    off = arm * np.exp(1j * (gone + course["turned"])) - course["wide"] * np.exp(
        1j * course["turned"])  # fmt: skip
    return _laid(course, off.real, off.imag)


def stirred(course: Course, gone_s: Floats, geared: float = 0.0) -> Floats:
    """Return where paddles are, in m [n, 3]: on wheels that are driven round (epitrochoids)."""
    gone = course["brisk"] * gone_s
    great = course["wide"] * (np.exp(1j * gone) - 1)
    small = course["bent"] * np.exp(1j * course["turned"])
    off = great + small * (np.exp(1j * (PLANET + geared) * gone) - 1)
    return _laid(course, off.real, off.imag, 0.05 * gone)


def hoisted(course: Course, gone_s: Floats, slips: float = 0.0) -> Floats:
    """Return where saggars are, in m [n, 3]: up from rest to an even pace, and aside by a crane."""
    run_s = FROM_REST_S * np.log(np.cosh(gone_s / FROM_REST_S))
    up = course["brisk"] * (1 - slips) * run_s
    return _laid(course, course["wide"] * run_s, 0.0 * run_s, up)


def dipped(course: Course, gone_s: Floats, across: float = 0.0) -> Floats:
    """Return where dippers are, in m [n, 3]: by sines along and across (Lissajous 1857)."""
    gone, begun = course["brisk"] * gone_s, course["turned"]
    ahead = course["wide"] * (np.sin(gone + begun) - np.sin(begun))
    aside = np.sin(ACROSS * gone + 2 * begun) - np.sin(2 * begun)
    return _laid(course, ahead, course["bent"] * (1 + across) * aside)


WAYS = (carried, rolled, spiralled, stirred, hoisted, dipped)


def at_trade(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["stirs"] * np.maximum(into_s, 0.0)
    places = np.full((len(gone_s), 3), np.nan)
    for number, way in enumerate(WAYS):
        own = np.flatnonzero(course["trade"] == number)
        if own.size:
            places[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return places


def lengths(ways: Floats) -> Floats:
    """Return how long ways [n, 3] are in m [n]."""
    return np.asarray(np.linalg.norm(ways, axis=1))


class Firing:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `tag`, `purlin` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare, self.rows = table, case, rng, rare, len(table)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["tx"]], np.int64)
        self.purlin: Integers = np.array([int(one[6:]) for one in table["rx"]], np.int64)
        codes, links = pd.factorize(table["link"], sort=True)
        self.link, self.links = np.asarray(codes, np.int64), len(links)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[column], np.float64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9603, what, self.case])

    def each_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(draws(self.links)[self.link], np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def purlin_m(self) -> Floats:
        """Where purlins are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, trade: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a trade [n]."""
        return np.array([one.startswith(trade) for one in self.table["tx"]], np.bool_)

    def through(self, what: str) -> Floats:
        """Return how many such things straight ways go through [n]."""
        return np.array([some.count(what) for some in self.table["obstacles"]], np.float64)

    def shut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        behind = np.array([bool(some) for some in self.table["obstacles"]])
        lots = self.rng.permutation(np.unique(self.link[behind]))
        chosen = lots[: max(1, round(share * self.links))]
        return np.isin(self.link, chosen).astype(np.float64)

    def longer_m(self, tag_off: Floats | float, purlin_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        way = self.tag_m - self.purlin_m
        return np.asarray(lengths(way + tag_off - purlin_off) - lengths(way))

    def draws_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now = self.course["into_s"]
        return self.longer_m(at_trade(self.course, now + later_s) - at_trade(self.course, now))
