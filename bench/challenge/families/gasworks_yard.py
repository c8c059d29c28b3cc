"""The gasworks: retorts, a gasholder, purifiers, who works there, and rows of these.

numpy and pandas alone. A retort house and a shed of purifiers stand in a yard of tanks; brackets,
radios at fixed places, call tags. Stokers rake to and fro; barrows are wheeled along clothoids
(Cornu 1874); bells rise and turn in spiral guides (Gadd 1888); skips are hauled up by jerks;
lamplighters stroll in eights (Gerono); rams are driven by a crank and a rod.
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
YARD_M = (42.0, 25.0, 9.5)
RETORTS_M, DOORS_M = 16.0, 15.0
"""Across, of the wall of the retort house; along, from where it is open."""
SHED_M: Floats = np.array([[18.0, 0.0], [28.0, 8.0]])
"""Of the shed of purifiers, its nearest and farthest corner."""
TANKS_M: Floats = np.array([
    [20.2, 13.0, 0.9], [24.6, 14.2, 0.9], [30.2, 10.6, 1.3], [34.0, 5.6, 1.0], [10.4, 21.0, 0.8],
    [5.2, 9.4, 0.6], [13.0, 5.2, 0.7], [27.4, 20.4, 1.2], [35.4, 13.8, 0.7], [38.0, 20.8, 3.3],
])  # fmt: skip
"""Across, along and radius in m, of upright tanks; the last is the gasholder's, in the ground."""
DAY_S = 11.0 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 3.4944  # channel 1
BRACKETS_M: Floats = np.array([
    [0.5, 3.2, 2.6], [0.6, 12.4, 4.8], [0.5, 22.2, 2.2], [6.4, 24.5, 5.6], [7.6, 0.5, 3.4],
    [15.4, 9.6, 6.2], [12.6, 24.4, 2.9], [15.5, 1.0, 2.4], [18.4, 24.4, 4.2], [17.2, 0.6, 5.2],
    [23.2, 7.4, 2.3], [28.6, 3.4, 3.8], [25.2, 24.5, 6.6], [32.4, 24.4, 2.7], [36.2, 0.6, 4.6],
    [41.4, 7.6, 2.5], [41.5, 14.8, 5.4], [33.2, 9.8, 7.2],
])  # fmt: skip
BRACKETS = len(BRACKETS_M)
TRADES = {"stoker": 3, "barrow": 2, "bell": 2, "skip": 2, "lamplighter": 2, "ram": 3}
"""How many tags there are of each trade."""
TAGS = tuple(f"{trade}{k}" for trade, count in TRADES.items() for k in range(count))
PLACES = {"stoker": "retort house", "barrow": "coke yard", "bell": "gasholder",
          "skip": "coal store", "lamplighter": "yard", "ram": "retort bench"}  # fmt: skip
COURSE = ("trade", "mid_x", "mid_y", "mid_z", "bears", "pace", "span", "curl", "turn",
          "works", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `gone_on`."""
FLIGHT_M = 0.74  # between flights of the coke conveyor
SLAMS_MBAR = 21.0  # of the main, over which a governor's valve is shut
AUNE_M = 1.188
LAWS = {
    "tar-clings-to-brackets": Law(("saturation", "logarithm", "power")),
    "naphthalene-grows-in-vents": Law(("logarithm", "power", "saturation")),
    "scurf-thickens-on-mouthpieces": Law(("linear", "power")),
    "lime-spends-itself-in-purifiers": Law(("power", "logarithm", "saturation")),
    "jib-of-the-coke-crane-close": Law(("inverse", "inverse square", "power")),
    "holder-lifts-before-brackets": Law(("power", "parabola")),
    "exhauster-off-its-best-speed": Law(("parabola",)),
    "flights-of-the-conveyor-pass": Law(("periodic",), FLIGHT_M, "m", grows=False),
    "governor-valve-slams-shut": Law(("step",), 0.094, "m"),
    "smoke-hangs-under-the-retort-roof": Law(),
    "steam-of-quenched-coke-drifts": Law(),
    "fires-glow-through-open-doors": Law(),
    "gauge-drags-behind-its-pressure": Law(),
    "stokers-reach-further-than-told": Law(),
    "barrows-veer-on-a-worn-wheel": Law(),
    "bells-turn-in-steeper-guides": Law(),
    "skips-surge-on-their-rope": Law(),
    "lamplighters-cut-their-eights": Law(),
    "rams-driven-by-a-shorter-rod": Law(),
    "places-told-at-the-last-tick": Law(),
    "yard-leans-towards-the-tank": Law(),
    "print-of-the-yard-has-shrunk": Law(),
    "made-ground-gives-under-coal": Law(),
    "retort-wall-bellies-as-it-heats": Law(),
    "answers-wait-for-the-exhausters-stroke": Law(),
    "third-answers-told-as-the-second": Law(),
    "answers-come-by-a-damped-float": Law(),
    "inches-booked-to-a-short-yard": Law(),
    "dial-hung-off-its-centre": Law(),
    "bracket-bent-by-a-ladder": Law(("position",), 0.51, "m", devices=("bracket6",)),
    "brackets-painted-with-each-others-numbers": Law(("swap",), devices=("bracket3", "bracket15")),
    "aunes-from-one-bracket": Law(("unit",), 1 / AUNE_M, "1", grows=False, devices=("bracket11",)),
}
"""What nobody's library has."""
Course = dict[str, Floats]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(14)
SHARPENS, SOFT, JERKS, PULLS = 0.035, 0.93, 1.3, 0.9
"""Of clothoids, radians for each m^2; of turns; radians a second of jerks, and their part."""


@dataclass(frozen=True)
class Bill:
    """What rows [n] are charged: m of range, dB of levels, of first paths, of noise, of counts."""

    more_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def room_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from outer walls, roof, ground and tanks, in m [n].

    < 0 outside, and within tanks; the gasholder's is in the ground.
    """
    outer = np.minimum(at, np.array(YARD_M) - at).min(axis=1)
    tanks = TANKS_M[:-1]
    off = np.linalg.norm(at[:, None, :2] - tanks[:, :2], axis=2) - tanks[:, 2]
    return np.asarray(np.minimum(outer, off.min(axis=1)))


def _from(course: Course, ahead: Floats, aside: Floats | float, up: Floats | float) -> Floats:
    """Return places so far ahead, aside and above where courses begin, in m [n, 3]."""
    east = ahead * np.cos(course["bears"]) - aside * np.sin(course["bears"])
    north = ahead * np.sin(course["bears"]) + aside * np.cos(course["bears"])
    here = (course["mid_x"] + east, course["mid_y"] + north, course["mid_z"] + up)
    return np.stack(np.broadcast_arrays(*here), axis=1)


def rakes(course: Course, gone_s: Floats, wider: float = 0.0) -> Floats:
    """Return where stokers are, in m [n, 3]: to and fro at an even pace, with soft turns.

    `span` m to either side, a part more if wider.
    """

    def swung(angle: Floats) -> Floats:
        return np.asarray(np.arcsin(SOFT * np.sin(angle)) / np.arcsin(SOFT))

    off = swung(course["turn"] + course["pace"] * gone_s) - swung(course["turn"])
    ahead = (1 + wider) * course["span"] * off
    return _from(course, ahead, 0.25 * ahead, 0.0)


def wheeled(course: Course, gone_s: Floats, veers: float = 0.0) -> Floats:
    """Return where barrows are, in m [n, 3]: on clothoids, at `pace`.

    They begin to turn by `curl` radians for each m, by `veers` more on a worn wheel.
    """
    way = course["pace"] * gone_s
    along = way[:, None] * 0.5 * (1 + NODES)
    bent = course["curl"] + veers
    heads = bent[:, None] * along + 0.5 * SHARPENS * np.sign(course["turn"])[:, None] * along**2
    ahead, aside = (0.5 * way * (one * WEIGHTS).sum(axis=1) for one in (np.cos(heads),
                                                                      np.sin(heads)))  # fmt: skip
    return _from(course, ahead, aside, 0.0)


def spirals(course: Course, gone_s: Floats, steeper: float = 0.0) -> Floats:
    """Return where marks on bells are, in m [n, 3]: up at `pace`, round by a radian each `curl` m.

    By a part more if guides are not as told; `span` m from the middle.
    """
    up = course["pace"] * gone_s
    angle = course["turn"] + (1 + steeper) * up / course["curl"]
    return _from(course, course["span"] * np.cos(angle), course["span"] * np.sin(angle), up)


def hauled(course: Course, gone_s: Floats, surges: float = 0.0) -> Floats:
    """Return where skips are, in m [n, 3]: at `pace` in the mean, by jerks, larger if they surge.

    Up by `span` m each m.
    """
    jerks = np.sin(JERKS * gone_s + course["turn"]) - np.sin(course["turn"])
    way = course["pace"] * (gone_s - PULLS * (1 + surges) * jerks / JERKS)
    return _from(course, way, 0.0, course["span"] * way)


def strolls(course: Course, gone_s: Floats, cuts: float = 0.0) -> Floats:
    """Return where lamplighters are, in m [n, 3]: in eights, a part slimmer if they cut these."""
    angle = course["turn"] + course["pace"] * gone_s
    wide, begun = (np.sin(one) * np.cos(one) for one in (angle, course["turn"]))
    aside = course["span"] * ((1 - cuts) * wide + cuts * begun)
    return _from(course, course["span"] * np.cos(angle), aside, 0.0)


def driven(course: Course, gone_s: Floats, shorter: float = 0.0) -> Floats:
    """Return where rams are, in m [n, 3]: by a crank of `span` m and a rod of `curl` m."""
    rod = np.maximum(course["curl"] / (1 + shorter), 1.08 * course["span"])

    def out(angle: Floats) -> Floats:
        aside = course["span"] * np.sin(angle)
        return np.asarray(course["span"] * np.cos(angle) + np.sqrt(rod**2 - aside**2))

    ahead = out(course["turn"] + course["pace"] * gone_s) - out(course["turn"])
    return _from(course, ahead, 0.0, 0.0)


WAYS = (rakes, wheeled, spirals, hauled, strolls, driven)


def gone_on(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["works"] * into_s.clip(0.0)
    made = np.zeros((len(gone_s), 3))
    for number, way in enumerate(WAYS):
        own = np.flatnonzero(course["trade"] == number)
        if own.size:
            made[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return made


class Charge:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `bracket`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare, self.rows = table, case, rng, rare, len(table)
        self.tag: Integers = table["rx"].map(TAGS.index).to_numpy(np.int64)
        self.bracket: Integers = table["tx"].str.slice(len("bracket")).to_numpy(np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"], sort=True)[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9203, what, self.case])

    def per_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
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
    def bracket_m(self) -> Floats:
        """Where brackets are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def are(self, trade: str) -> Integers:
        """Return which rows are of tags of a trade."""
        return np.flatnonzero(self.table["rx"].str.startswith(trade))

    def met(self, what: str) -> Floats:
        """Return how many such things straight ways go through [n]."""
        return np.asarray([[*some].count(what) for some in self.table["obstacles"]], np.float64)

    def shut_in(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        behind = np.unique(self.link[self.table["obstacles"].str.len().to_numpy() > 0])
        most = min(len(behind), max(1, round(share * (int(self.link.max()) + 1))))
        return np.isin(self.link, self.rng.choice(behind, most, replace=False)).astype(np.float64)

    def longer_m(self, tag_off: Floats | float, bracket_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        way = self.bracket_m - self.tag_m
        return np.asarray(np.linalg.norm(way + bracket_off - tag_off, axis=1)
                          - np.linalg.norm(way, axis=1))  # fmt: skip

    def gets_away(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now = self.course["into_s"]
        return self.longer_m(gone_on(self.course, now + later_s) - gone_on(self.course, now))
