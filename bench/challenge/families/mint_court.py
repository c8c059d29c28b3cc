"""The mint: fly presses, trucks, warders, coils, ladles and couriers, and rows of these.

numpy and pandas alone. Four wings stand about an open court; quoins, radios at corners, call tags.
Arms of presses swing to and fro on a screw; trucks follow rails that bend ever more
(clothoids); warders look in at doors by a figure of Lissajous; coils of strip unwind (spirals of
Archimedes); ladles go from rest to rest with the least jerk; couriers change over to the other side
of a passage by a hyperbolic tangent.
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
ROOM_M = (38.0, 30.0, 8.0)
COURT_M: Floats = np.array([[13.0, 10.0], [25.0, 20.0]])
"""The open court, from its nearest to its farthest corner."""
DAY_S = 8.0 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 7.9872  # channel 9
QUOINS_M: Floats = np.array([
    [0.5, 3.8, 3.2], [0.5, 14.6, 5.6], [0.6, 25.8, 2.6], [6.4, 29.4, 4.4], [7.2, 0.6, 6.4],
    [12.4, 9.4, 2.8], [12.5, 20.6, 6.0], [14.8, 29.5, 2.5], [16.6, 0.5, 3.6], [18.8, 9.5, 7.2],
    [19.6, 20.5, 3.0], [24.6, 29.4, 6.6], [25.6, 9.3, 5.2], [25.5, 20.7, 2.4], [26.8, 0.6, 2.7],
    [34.0, 29.5, 3.4], [37.5, 22.4, 5.8], [37.4, 12.2, 2.9], [36.8, 0.7, 4.8],
])  # fmt: skip
QUOINS = len(QUOINS_M)
KINDS = {"press": 2, "truck": 3, "warder": 3, "coil": 2, "ladle": 2, "courier": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"press": "coining hall", "truck": "bullion passage", "warder": "strongroom",
          "coil": "rolling hall", "ladle": "melting house", "courier": "passages"}  # fmt: skip
COURSE = ("way", "mid_x", "mid_y", "mid_z", "bears", "fast", "size", "second", "begins",
          "moving", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `taken`."""
REED_M = 0.83  # between ribs that a reeding wheel runs over
FLUE_C = 260.0  # at which a fan is thrown in
TOISE_M = 1.94904
LAWS = {
    "gold-dust-settles-on-quoins": Law(("saturation", "logarithm", "power")),
    "pickle-fumes-eat-at-covers": Law(("logarithm", "power", "saturation")),
    "strip-is-rolled-thick": Law(("linear", "power")),
    "borax-creeps-since-fluxed": Law(("power", "logarithm", "saturation")),
    "coin-hopper-swung-close": Law(("inverse square", "inverse", "power")),
    "bullion-piled-before-quoins": Law(("power", "parabola")),
    "annealing-reddens-and-pales": Law(("parabola",)),
    "ribs-of-reeding-wheels-pass": Law(("periodic",), REED_M, "m", grows=False),
    "fan-thrown-in-at-a-hot-flue": Law(("step",), 0.096, "m"),
    "caged-passage-guides-what-passes": Law(),
    "seals-leak-by-what-pressures-differ": Law(),
    "presses-swing-further-than-told": Law(),
    "rails-bend-sooner-than-drawn": Law(),
    "warders-hurry-across": Law(),
    "coils-spring-open": Law(),
    "ladles-hang-back-as-they-gain": Law(),
    "couriers-cut-across-sooner": Law(),
    "places-smoothed-both-ways": Law(),
    "heights-told-by-a-barometer": Law(),
    "strongroom-door-swings-its-quoins": Law(),
    "circle-of-the-theodolite-off-centre": Law(),
    "levels-sighted-over-a-hot-floor": Law(),
    "batteries-sag-as-answers-crowd": Law(),
    "coarse-count-read-before-it-ripples": Law(),
    "bags-of-answers-opened-out-of-order": Law(),
    "answers-held-while-presses-strike": Law(),
    "ranges-told-along-the-floor": Law(),
    "quoin-barged-by-a-dray": Law(("position",), 0.52, "m", devices=("quoin13",)),
    "quoins-sealed-with-each-others-stamps": Law(("swap",), devices=("quoin6", "quoin16")),
    "toises-from-one-quoin": Law(("unit",), 1 / TOISE_M, "1", grows=False, devices=("quoin10",)),
}
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Toll:
    """What is taken of rows [n]: m of range, dB of levels, first paths, noise and counts."""

    longer_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def inside_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from walls, floor or vaults, in m [n]; < 0 outside."""
    outer = np.minimum(at, np.array(ROOM_M) - at)
    outer[:, 2] = np.minimum(at[:, 2], ROOM_M[2] - 0.4 - at[:, 2])
    middle, half = COURT_M.mean(axis=0), 0.5 * (COURT_M[1] - COURT_M[0])
    from_court = (np.abs(at[:, :2] - middle) - half).max(axis=1)
    return np.asarray(np.minimum(outer.min(axis=1), from_court))


def _off(course: Course, ahead: Floats, aside: Floats, up: Floats | float) -> Floats:
    """Return places ahead of and beside where courses bear, and above, in m [n, 3]."""
    cos, sin = np.cos(course["bears"]), np.sin(course["bears"])
    return np.column_stack([course["mid_x"] + ahead * cos - aside * sin,
                            course["mid_y"] + ahead * sin + aside * cos,
                            course["mid_z"] + up])  # fmt: skip


def flies(course: Course, gone_s: Floats, further: float = 0.0) -> Floats:
    """Return where ends of fly presses' arms are, in m [n, 3]: `size` long, on a screw.

    They swing by `second` radians and a part more.
    """
    swung = course["second"] * (np.sin(course["begins"] + course["fast"] * gone_s))
    swung = swung + further * course["second"] * np.sin(course["fast"] * gone_s)
    return _off(course, course["size"] * np.cos(swung), course["size"] * np.sin(swung),
                0.4 * swung / (2 * np.pi))  # fmt: skip


NODES, WEIGHTS = (np.asarray(one) for one in np.polynomial.legendre.leggauss(7))


def rides(course: Course, gone_s: Floats, sooner: float = 0.0) -> Floats:
    """Return where trucks are, in m [n, 3]: rails bend by `second` more radians/m each metre.

    (Euler 1744.) By a part sooner.
    """
    gone = course["fast"] * gone_s
    along = 0.5 * gone[:, None] * (NODES + 1)
    bend = course["begins"][:, None] * 0.05 + course["second"][:, None] * (1 + sooner) * along / 2
    heads = bend * along
    ahead, aside = (0.5 * gone * (one(heads) @ WEIGHTS) for one in (np.cos, np.sin))
    return _off(course, ahead, aside, 0.0)


def looks_in(course: Course, gone_s: Floats, hurries: float = 0.0) -> Floats:
    """Return where warders are, in m [n, 3]: twice along for three times across (Lissajous 1857).

    They go across by a part faster.
    """
    turn = course["fast"] * gone_s
    ahead = course["size"] * np.sin(2 * turn + course["begins"])
    aside = course["second"] * np.cos(3 * turn * (1 + hurries))
    return _off(course, ahead, aside, 0.0)


def unwinds(course: Course, gone_s: Floats, springs: float = 0.0) -> Floats:
    """Return where ends of coils are, in m [n, 3]: `second` m wider each turn (Archimedes).

    By a part more once these spring open.
    """
    turned = course["fast"] * gone_s
    wide = course["size"] + (1 + springs) * course["second"] * np.abs(turned) / (2 * np.pi)
    angle = course["begins"] + turned
    return _off(course, wide * np.cos(angle), wide * np.sin(angle), 0.0)


def carries(course: Course, gone_s: Floats, hangs_s2: float = 0.0) -> Floats:
    """Return where ladles are, in m [n, 3]: `size` m in `second` s (Flash and Hogan 1985).

    They hang back by so much for each m/s^2.
    """
    part = (gone_s / course["second"]).clip(0.0, 1.0)
    come = part**3 * (10 - 15 * part + 6 * part**2)
    gains = 60 * part * (1 - part) * (1 - 2 * part) / course["second"] ** 2
    return _off(course, course["size"] * (come - hangs_s2 * gains), 0.0 * part, 0.0)


def runs(course: Course, gone_s: Floats, sooner_m: float = 0.0) -> Floats:
    """Return where couriers are, in m [n, 3]: `size` m over, amid which they are at `second` m."""
    gone = course["fast"] * gone_s
    over = np.tanh((gone + sooner_m - course["second"]) / 0.9)
    begun = np.tanh((sooner_m - course["second"]) / 0.9)
    return _off(course, gone, 0.5 * course["size"] * (over - begun), 0.0)


WAYS = (flies, rides, looks_in, unwinds, carries, runs)


def taken(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = (course["moving"] * into_s).clip(0.0)
    made = np.zeros((len(gone_s), 3))
    for way in np.unique(course["way"]):
        own = course["way"] == way
        made[own] = WAYS[int(way)]({name: one[own] for name, one in course.items()}, gone_s[own])
    return made


class Tally:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `quoin`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare, self.rows = table, case, rng, rare, len(table)
        self.quoin: Integers = np.asarray(table["tx"].str[len("quoin") :], np.int64)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["rx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([7303, what, self.case])

    def links(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def quoin_m(self) -> Floats:
        """Where quoins are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    @cached_property
    def of_run(self) -> Integers:
        """Numbers of runs [n]."""
        return np.asarray(self.table["link"].str.extract(r"turn (\d+)")[0], np.int64)

    def are(self, kind: str) -> Bools:
        """Return which rows are of tags of a kind [n]."""
        return self.table["rx"].str.startswith(kind).to_numpy(np.bool_)

    def meets(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def cut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        stands = self.table["obstacles"].str.len().to_numpy() > 0
        behind = np.unique(self.link[stands])
        most = max(1, round(share * (int(self.link.max()) + 1)))
        picked = self.rng.choice(behind, min(most, len(behind)), replace=False)
        return np.isin(self.link, picked).astype(np.float64)

    def grown_m(self, tag_off: Floats | float, quoin_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        told = self.tag_m - self.quoin_m
        true = told + tag_off - quoin_off
        return np.asarray(np.linalg.norm(true, axis=1) - np.linalg.norm(told, axis=1))

    def recedes(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now = self.course["into_s"]
        return self.grown_m(taken(self.course, now + later_s) - taken(self.course, now))
