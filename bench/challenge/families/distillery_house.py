"""The distillery: casks, rummagers, maltmen, drays, hoists and cats, and rows of these.

numpy and pandas alone. A malt barn and a still house make an L; radios over lintels hear tags.
Casks roll along, with a tag near the rim of a head (trochoids); rummagers drag chains round (a
circle on a circle); maltmen turn the floor to and fro; drays gather or lose way evenly; hoists
settle against a dashpot; cats close in on something by a spiral of even angle.
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
ROOM_M = (34.0, 24.0, 11.0)
BARN_M, STILLS_M = ((0.0, 34.0), (0.0, 10.0)), ((20.0, 34.0), (0.0, 24.0))
"""From where to where the barn and the still house go, along and across."""
INNER_M: Floats = np.array([20.0, 10.0])
"""Of the L's inner corner; what is before it and beyond is outside."""
DAY_S = 7.5 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 6.4896  # channel 5
LINTELS_M: Floats = np.array([
    [0.6, 5.2, 5.8], [3.6, 0.5, 2.4], [5.0, 9.5, 4.4], [9.4, 0.4, 6.6], [10.6, 9.6, 2.3],
    [15.0, 0.5, 3.2], [16.2, 9.5, 7.4], [20.4, 13.0, 3.1], [20.5, 20.4, 6.2], [25.2, 23.5, 2.5],
    [33.5, 17.6, 4.0], [33.4, 9.4, 2.4], [30.6, 0.5, 5.4], [24.0, 0.6, 8.6], [27.0, 10.6, 9.9],
])  # fmt: skip
LINTELS = len(LINTELS_M)
POTS_M: Floats = np.array([
    [23.4, 14.2, 3.4], [30.4, 14.6, 3.0], [23.6, 19.6, 3.2], [30.2, 20.2, 3.6], [27.0, 4.6, 2.6],
    [7.2, 5.0, 2.4],
])  # fmt: skip
"""Shoulders of four stills, of a mash tun's dome and of a steep's."""
KINDS = {"cask": 3, "rummager": 2, "maltman": 3, "dray": 2, "hoist": 2, "cat": 2}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"cask": "warehouse", "rummager": "still house", "maltman": "malt floor",
          "dray": "yard", "hoist": "loft", "cat": "malt floor"}  # fmt: skip
COURSE = ("sort", "at_x", "at_y", "at_z", "aim", "pace", "wide", "small", "phase", "goes", "into_s")
"""How a tag goes, known to nobody; see `taken`."""
RAKE_M = 0.47  # between a mash rake's teeth
LIFTS_BAR = 2.35  # at which a valve lifts
KLAFTER_M = 1.8965  # Viennese
LAWS = {
    "peat-reek-clings-to-lintels": Law(("saturation", "logarithm", "power")),
    "angels-share-gone-from-casks": Law(("logarithm", "power", "saturation")),
    "worm-tubs-run-warm": Law(("linear", "power")),
    "barley-swells-in-the-steep": Law(("power", "logarithm", "saturation")),
    "coppersmiths-stand-close": Law(("inverse square", "inverse", "power")),
    "draff-heaped-against-doors": Law(("power", "parabola")),
    "froth-rises-and-falls-in-washbacks": Law(("parabola",)),
    "teeth-of-mash-rakes-pass": Law(("periodic",), RAKE_M, "m", grows=False),
    "valve-lifts-at-high-steam": Law(("step",), 0.092, "m"),
    "spirit-vapour-fills-the-still-house": Law(),
    "door-between-halls-shut-by-turns": Law(),
    "casks-skid-as-they-roll": Law(),
    "chains-of-rummagers-fly-out": Law(),
    "maltmen-tire-as-they-turn": Law(),
    "drays-sway-on-the-setts": Law(),
    "hoists-bob-on-their-chains": Law(),
    "cats-close-in-sooner": Law(),
    "places-queue-behind-answers": Law(),
    "loft-bends-under-barley": Law(),
    "tape-stretched-when-wet": Law(),
    "still-house-laid-out-off-the-square": Law(),
    "upper-lintels-levelled-from-the-loft": Law(),
    "answers-overshoot-by-what-they-rose": Law(),
    "answers-vatted-over-a-run": Law(),
    "gauge-narrows-past-a-mark": Law(),
    "lintel-shouldered-by-a-still": Law(("position",), 0.49, "m", devices=("lintel6",)),
    "lintels-entered-on-each-others-lines": Law(("swap",), devices=("lintel3", "lintel9")),
    "klafters-from-one-lintel": Law(
        ("unit",), 1 / KLAFTER_M, "1", grows=False, devices=("lintel11",)
    ),
}
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Duty:
    """What is levied on rows [n]: m of range, dB of levels, first paths, noise and counts."""

    late_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    summed_db: Floats | float = 0.0


def indoors_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from walls, floor or roof, in m [n]; < 0 outside."""
    halls = [
        np.minimum(at[:, :2] - np.array(hall).T[0], np.array(hall).T[1] - at[:, :2]).min(axis=1)
        for hall in (BARN_M, STILLS_M)
    ]
    upright = np.minimum(at[:, 2], ROOM_M[2] - 0.5 - at[:, 2])
    return np.asarray(np.minimum(np.max(halls, axis=0), upright))


def _beside(course: Course, along: Floats, aside: Floats | float, up: Floats | float) -> Floats:
    """Return places so far along where tags aim, aside from that and up, in m [n, 3]."""
    cos, sin = np.cos(course["aim"]), np.sin(course["aim"])
    return np.column_stack([course["at_x"] + along * cos - aside * sin,
                            course["at_y"] + along * sin + aside * cos,
                            course["at_z"] + up])  # fmt: skip


def rolls(course: Course, gone_s: Floats, skids: float = 0.0) -> Floats:
    """Return where casks' tags are, in m [n, 3]: `small` off the middle of heads `wide`.

    That skid come less far by a part.
    """
    rolled = course["pace"] * gone_s
    angle = course["phase"] + rolled / course["wide"]
    along = (1 - skids) * rolled - course["small"] * (np.sin(angle) - np.sin(course["phase"]))
    return _beside(course, along, 0.0, -course["small"] * np.cos(angle))


def rakes(course: Course, gone_s: Floats, flung: float = 0.0) -> Floats:
    """Return where rummagers' chains are, in m [n, 3]: `small` circles on circles `wide`."""
    angle = course["phase"] + course["pace"] * gone_s
    wide = course["wide"] * (1 + flung)
    return _beside(course, wide * np.cos(angle) + course["small"] * np.cos(3 * angle),
                   wide * np.sin(angle) + course["small"] * np.sin(3 * angle), 0.0)  # fmt: skip


def shovels(course: Course, gone_s: Floats, tires: float = 0.0) -> Floats:
    """Return where maltmen are, in m [n, 3]: to and fro at an even pace, turns rounded.

    Who tires falls behind by the square of time, by such a part once 8 s have gone.
    """
    turn = course["phase"] + course["pace"] * gone_s * (1 - tires * gone_s / 8.0)
    aside = course["wide"] * 2 / np.pi * np.arcsin(0.96 * np.sin(turn))
    return _beside(course, course["small"] * gone_s, aside, 0.0)


def hauls(course: Course, gone_s: Floats, sways: float = 0.0) -> Floats:
    """Return where drays are, in m [n, 3], that gain `small` m/s a second; they sway by m."""
    along = course["pace"] * gone_s + 0.5 * course["small"] * gone_s**2
    aside = sways * (np.sin(2.1 * gone_s + course["phase"]) - np.sin(course["phase"]))
    return _beside(course, along, aside, 0.0)


def lifts(course: Course, gone_s: Floats, bobs: float = 0.0) -> Floats:
    """Return where hoists' hooks are, in m [n, 3]: up by `wide`, to 1 / e in `small` s.

    They bob by m, which dies off.
    """
    up = -course["wide"] * np.expm1(-gone_s / course["small"])
    up = up + bobs * np.exp(-gone_s / 6.0) * np.sin(2.4 * gone_s)
    return _beside(course, course["pace"] * gone_s, 0.0, up)


def prowls(course: Course, gone_s: Floats, sooner: float = 0.0) -> Floats:
    """Return where cats are, in m [n, 3]: on spirals that shrink by `small` parts a second."""
    angle = course["phase"] + course["pace"] * gone_s
    near = course["wide"] * np.exp(-course["small"] * (1 + sooner) * gone_s)
    return _beside(course, near * np.cos(angle), near * np.sin(angle), 0.0)


WAYS = (rolls, rakes, shovels, hauls, lifts, prowls)


def taken(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = (course["goes"] * into_s).clip(0.0)
    made = np.zeros((len(gone_s), 3))
    for sort in np.unique(course["sort"]):
        own = course["sort"] == sort
        made[own] = WAYS[int(sort)]({name: one[own] for name, one in course.items()}, gone_s[own])
    return made


class Run:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `lintel`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.rng, self.case, self.rare = table, rng, case, rare
        self.rows = len(table)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["tx"]], np.int64)
        heard = table["rx"].str.removeprefix("lintel")
        self.lintel: Integers = heard.to_numpy().astype(np.int64)
        self.link: Integers = np.asarray(table.groupby("link", sort=False).ngroup(), np.int64)
        self.links = int(self.link.max()) + 1

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([6203, what, self.case])

    def by_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(np.take(draws(self.links), self.link), np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def lintel_m(self) -> Floats:
        """Where lintels are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, kind: str) -> Bools:
        """Return which rows are of tags of a kind [n]."""
        return np.array([TAGS[one].startswith(kind) for one in self.tag], np.bool_)

    def through(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def shut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        behind = np.unique(self.link[np.array([len(o) > 0 for o in self.table["obstacles"]])])
        order = self.rng.permutation(behind)
        return np.isin(self.link, order[: max(1, round(share * self.links))]).astype(np.float64)

    def stretched_m(self, tag_off: Floats | float, lintel_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        told = self.lintel_m - self.tag_m
        there = told + lintel_off - tag_off
        return np.asarray(np.sqrt((there**2).sum(axis=1)) - np.sqrt((told**2).sum(axis=1)))

    def draws_away(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        was, by = self.course["into_s"], self.course
        return self.stretched_m(taken(by, was + later_s) - taken(by, was))
