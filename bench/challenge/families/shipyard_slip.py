"""The shipyard: cradles, drums, haulers and punts in its building dock, and rows of these.

numpy and pandas alone. Derricks about the dock have radios; three of them stand on a pontoon and
two on the deck of the hull. Cradles run down ways and are held by water as the square of their
speed; drums of cable are rolled, with their tags at the flange; haulers walk a line off a capstan,
by its circle's involute; punts are towed from a quay, by a tractrix.
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
DOCK_M = (66.0, 38.0, 21.0)
PPM_MS_M = 0.149896229  # a millionth of half the way that light makes in a millisecond
WAVE_M = 0.299792458 / 4.4928  # channel 3
TIDE_S = 10.2 * 3600
RIB_M = 0.69  # from one rib of the hull to the next
AFLOAT_M = 3.1  # of draught, over which the caisson floats
SPAN_M = 0.2286
DERRICKS_M: Floats = np.array(
    [(2.0, 6.0, 4.1), (2.4, 31.0, 6.2), (14.0, 2.0, 5.4), (29.0, 1.8, 3.6), (45.0, 2.2, 6.8),
     (63.8, 9.0, 4.6), (63.5, 29.0, 5.8), (48.0, 36.0, 3.3), (33.0, 36.2, 3.8), (17.0, 35.8, 3.5),
     (24.5, 19.0, 8.5), (51.0, 19.0, 8.9)]
)  # fmt: skip
"""Where derricks have their radios, in m [DERRICKS, 3]."""
DERRICKS, AFLOAT, ON_DECK = len(DERRICKS_M), (7, 8, 9), (10, 11)
TANKS_M: Floats = np.array([(18.0, 19.0, 9.6), (31.0, 19.0, 9.6), (44.0, 19.0, 9.6)])
TANK_M = 3.6  # half as wide as the balls of steel are that will hold gas, and whose middles these
KINDS = {"cradle": 2, "drum": 4, "hauler": 4, "punt": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"cradle": "ways", "drum": "cable store", "hauler": "quay", "punt": "basin"}
COURSE = ("kind", "east", "north", "up", "bears", "pace", "size", "begins", "goes", "into_s")
"""How a tag goes, known to nobody; see `come_to`."""
DECLINES = 1 / 18  # of the ways
AT_FLANGE = 0.8  # of a drum's half, from its axle to its tag
LAWS = {
    "salt-crusts-on-covers": Law(("saturation", "logarithm", "power")),
    "weed-grows-on-fenders": Law(("power", "logarithm", "saturation")),
    "anvil-dragged-close-by": Law(("power", "inverse square", "inverse")),
    "caulking-dries-since-wetted": Law(("logarithm", "power", "saturation")),
    "shackles-heaped-beside": Law(("linear", "power")),
    "ribs-of-the-hull-pass": Law(("periodic",), RIB_M, "m", grows=False),
    "caisson-floats-at-a-draught": Law(("step",), 0.098, "m"),
    "mist-lies-up-to-a-height": Law(),
    "grease-stiffens-on-the-ways": Law(),
    "drums-roll-on-thinner-flanges": Law(),
    "punts-make-leeway": Law(),
    "pontoon-rides-the-tide": Law(),
    "hull-lists-with-its-ballast": Law(),
    "heights-told-above-a-raking-keel": Law(),
    "medians-of-three-sent": Law(),
    "derrick-nudged-by-a-bowsprit": Law(("position",), 0.51, "m", devices=("derrick4",)),
    "derricks-given-each-others-signals": Law(("swap",), devices=("derrick1", "derrick5")),
    "spans-from-one-derrick": Law(
        ("unit",), 1 / SPAN_M, "1", grows=False, devices=("derrick2",)
    ),
}  # fmt: skip
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Toll:
    """What rows [n] pay: `late_m` of range; dB of all, first paths, noise and counts."""

    late_m: Floats | float = 0.0
    dim_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    hiss_db: Floats | float = 0.0
    tally_db: Floats | float = 0.0


def inside_m(x: Floats, y: Floats) -> Floats:
    """Return how far places are from the nearest side of the dock in m [...]; < 0 beyond it."""
    aside = [0.5 * long - np.abs(at - 0.5 * long) for at, long in zip((x, y), DOCK_M, strict=False)]
    return np.asarray(np.minimum(*aside))


def _set_out(course: Course, ahead: Floats, left: Floats, up: Floats) -> Floats:
    """Return places so far ahead and to the left of where courses begin, in m [n, 3]."""
    cosine, sine = np.cos(course["bears"]), np.sin(course["bears"])
    east = course["east"] + ahead * cosine - left * sine
    north = course["north"] + ahead * sine + left * cosine
    return np.column_stack([east, north, up])


def run_down(course: Course, gone_s: Floats, stiff: float = 0.0) -> Floats:
    """Return where cradles are, in m [n, 3]: ever nearer to a speed at which water holds them.

    What falls and is held by its speed's square comes by a logarithm of a cosh. `stiff`: the part
    by which that speed is less.
    """
    most, pulls = course["pace"] * (1 - stiff), course["size"]
    way = most**2 / pulls * np.log(np.cosh(pulls * gone_s / most))
    return _set_out(course, way, 0 * way, course["up"] - DECLINES * way)


def rolled_on(course: Course, gone_s: Floats, thinner: float = 0.0) -> Floats:
    """Return where drums' tags are, in m [n, 3], on trochoids; flanges are thinner by a part."""
    way = course["pace"] * gone_s
    turn = course["begins"] - way / course["size"] / (1 - thinner)
    arm = AT_FLANGE * course["size"]
    return _set_out(course, way + arm * np.cos(turn), 0 * way, course["size"] + arm * np.sin(turn))


def walked_off(course: Course, gone_s: Floats) -> Floats:
    """Return where haulers are, in m [n, 3]: at even pace on the involute of a capstan."""
    turn = np.sqrt(course["begins"] ** 2 + 2 * course["pace"] * gone_s / course["size"])
    ahead = np.cos(turn) + turn * np.sin(turn)
    left = np.sin(turn) - turn * np.cos(turn)
    return _set_out(course, course["size"] * ahead, course["size"] * left, course["up"])


def towed(course: Course, gone_s: Floats) -> Floats:
    """Return where punts are, in m [n, 3]: on the tractrix of a line that is walked along a quay.

    `size`: of the line; `begins`: how many lines' lengths who tows has already come.
    """
    come = course["begins"] + course["pace"] * gone_s / course["size"]
    long = course["size"]
    return _set_out(course, long * (come - np.tanh(come)), long / np.cosh(come), course["up"])


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (run_down, rolled_on, walked_off, towed)
"""Of kinds as in KINDS."""


def come_to(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * into_s
    there = np.full((len(gone_s), 3), np.nan)
    for kind in np.unique(course["kind"]).astype(np.int64).tolist():
        own = np.flatnonzero(course["kind"] == kind)
        there[own] = WAYS[kind]({name: one[own] for name, one in course.items()}, gone_s[own])
    return there


class Berth:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `derrick`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        names = [f"derrick{k}" for k in range(DERRICKS)]
        self.derrick: Integers = pd.Categorical(table["rx"], names).codes.astype(np.int64)
        self.tag: Integers = pd.Categorical(table["tx"], TAGS).codes.astype(np.int64)
        self.link: Integers = np.asarray(table.groupby("link", sort=False).ngroup(), np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[column], np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([3903, what, self.case])

    def each(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(draws(1 + int(self.link.max())), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return np.column_stack([self[f"tx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def top_m(self) -> Floats:
        """Where derricks' radios are said to be, in m [n, 3]."""
        return np.column_stack([self[f"rx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.course["kind"] == [*KINDS].index(kind))

    def on(self, some: tuple[int, ...]) -> Floats:
        """Return 1 at rows of some derricks, else 0 [n]."""
        return np.isin(self.derrick, some).astype(np.float64)

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return self.table["obstacles"].map(lambda some: float(what in some)).to_numpy(np.float64)

    def cut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        links = 1 + int(self.link.max())
        hid = np.zeros(links, np.bool_)
        hid[self.link] = self.table["obstacles"].map(bool).to_numpy()
        order = np.argsort(np.where(hid, self.rng.random(links), 2.0))
        count = min(max(round(share * links), 1), int(hid.sum()))
        return np.isin(self.link, order[:count]).astype(np.float64)

    def longer(self, tag_off_m: Floats | float, top_off_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much [n, 3], in m [n]."""
        said = self.top_m - self.tag_m
        real = said + top_off_m - tag_off_m
        ways = np.sqrt(np.stack([real**2, said**2]).sum(axis=2))
        return np.asarray(ways[0] - ways[1])

    def hauls_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.longer(come_to(self.course, now_s + later_s) - come_to(self.course, now_s))
