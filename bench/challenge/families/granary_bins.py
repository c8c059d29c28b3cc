"""The granary: augers, buckets, sacks and barrows among round bins, and rows of these.

numpy and pandas alone. Spouts with radios stick out of the walls and hang below the roof. Augers
sweep a flat store by Archimedes's spiral and are turned by a shaft with Hooke's joint; buckets hang
on a chain that runs over six-sided wheels; sacks slide down troughs that are cycloids; barrows are
pushed round four bins by steps.
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
HALL_M = (54.0, 36.0, 15.0)
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 4
DAY_S = 9.0 * 3600
PIN_M = 0.84  # from one pin of the elevator's chain to the next
MAGNET_A = 17.5  # from which the drum that takes out nails holds these
FAMN_M = 1.7814  # of Sweden
BINS_M: Floats = np.array([(13.0, 10.0), (13.0, 26.0), (27.0, 10.0), (27.0, 26.0)])
"""Middles of round bins."""
BIN_M = 3.6  # their radius
AMID_M, AXES_M = (
    (20.0, 18.0),
    (13.0, 14.0),
)  # of the alley: its middle, its half axes
FOOT_M, TOP_M = (16.8, 18.0, 0.9), (22.9, 18.0, 13.0)  # of the elevator's legs
LEGS_M, RIM_M = 0.6, 0.32  # by which either leg is aside; radius of wheels at their corners
CREEP_M = 0.42  # by which augers come out with each turn
STORE_M = (43.5, 18.0)  # the middle of the flat store
CHUTE_M, ROUND_M, DEEP_M = 43.1, 2.1, 1.1  # of cycloids: middle along the hall, wheel, lowest
SPOUTS_M: Floats = np.array(
    [(2.2, 4.5, 3.4), (1.6, 19.0, 5.2), (3.0, 33.2, 2.6), (20.5, 1.4, 4.6), (21.0, 34.6, 3.8),
     (35.5, 2.4, 6.1), (36.2, 33.4, 2.9), (52.3, 3.0, 3.1), (52.6, 17.2, 4.9), (51.5, 32.8, 5.6),
     (9.0, 18.0, 12.6), (34.0, 18.5, 12.9)]
)  # fmt: skip
"""Where spouts have their radios, in m [SPOUTS, 3]; the last two hang below the roof."""
SPOUTS = len(SPOUTS_M)
KINDS = {"auger": 2, "bucket": 3, "sack": 2, "barrow": 4}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"auger": "flat store", "bucket": "elevator", "sack": "chutes", "barrow": "alley"}
COURSE = ("craft", "outset", "side", "height", "rate", "nods", "bent", "phase", "runs", "into_s")
"""How a tag goes, known to nobody; see `shifted`."""
LAWS = {
    "chaff-clings-to-spouts": Law(("saturation", "logarithm", "power")),
    "meal-cakes-on-covers": Law(("power", "parabola")),
    "drier-stands-close-by": Law(("inverse", "power", "inverse square")),
    "tallow-creeps-since-greased": Law(("logarithm", "power", "saturation")),
    "sacks-lean-on-posts": Law(("linear", "power")),
    "chain-pins-pass": Law(("periodic",), PIN_M, "m", grows=False),
    "magnet-drum-holds-nails": Law(("step",), 0.094, "m"),
    "damp-wheat-heats": Law(),
    "sacks-rub-in-chutes": Law(),
    "elevator-racked-aside": Law(),
    "augers-bend-back": Law(),
    "walls-bulge-when-filled": Law(),
    "sighted-with-a-tilted-axis": Law(),
    "spout-bent-by-a-lorry": Law(("position",), 0.47, "m", devices=("spout6",)),
    "spouts-wired-crosswise": Law(("swap",), devices=("spout2", "spout9")),
    "famnar-from-one-spout": Law(("unit",), 1 / FAMN_M, "1", grows=False, devices=("spout5",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Freight:
    """What rows [n] carry: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def hooked(turn: Floats, bent: Floats) -> Floats:
    """Return how far a shaft has turned, in radians [n], that another turns at an angle to it.

    By Hooke's joint: tangents are as the angle's cosine; both have turned alike after a half.
    """
    sine, cosine = np.sin(turn), np.cos(turn)
    ahead = np.arctan2((1 - np.cos(bent)) * sine * cosine, np.cos(bent) * cosine**2 + sine**2)
    return np.asarray(turn + ahead)


def swept(course: Course, gone_s: Floats, back_rad: Floats | float = 0.0) -> Floats:
    """Return where augers' ends are that are bent back by so much, in m [n, 3]."""
    turn = hooked(course["rate"] * gone_s + course["phase"], course["bent"])
    out = course["outset"] + CREEP_M * (turn - course["phase"]) / (2 * np.pi)
    at = turn - back_rad
    x, y = STORE_M[0] + out * np.cos(at), STORE_M[1] + out * np.sin(at)
    return np.stack([x, y, course["height"]], axis=1)


def paid_out(turn: Floats) -> Floats:
    """Return how much chain a six-sided wheel has paid out after so many radians, in m [n].

    Each side is a chord, across which the lever is a cosine: chains go by jerks.
    """
    side, part = np.divmod(turn, np.pi / 3)
    return np.asarray(RIM_M * (side + np.sin(part - np.pi / 6) + 0.5))


def on_legs(up_m: Floats, side: Floats) -> Floats:
    """Return places so far up the elevator's legs, the one or the other, in m [n, 3]."""
    foot, top = np.array(FOOT_M), np.array(TOP_M)
    along = (top - foot) / np.linalg.norm(top - foot)
    there = foot + up_m[:, None] * along
    there[:, 1] += LEGS_M * side
    return np.asarray(there)


def risen_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far up the legs buckets are, in m [n]: on one side they go up, else down."""
    run = paid_out((course["outset"] + course["rate"] * gone_s) * np.pi / (3 * RIM_M))
    long = float(np.linalg.norm(np.subtract(TOP_M, FOOT_M)))
    return np.asarray(np.where(course["side"] > 0, run, long - run))


def on_cycloid(slid_m: Floats, side: Floats, height: Floats) -> Floats:
    """Return places so far from troughs' lowest, along these, and above them, in m [n, 3].

    Of a wheel of ROUND_M that rolls below a line: what has slid is 4 ROUND_M sines of half turns.
    """
    half = np.arcsin((slid_m / (4 * ROUND_M)).clip(-1.0, 1.0))
    x = CHUTE_M + side * ROUND_M * (2 * half + np.sin(2 * half))
    z = DEEP_M + ROUND_M * (1 - np.cos(2 * half)) + height
    return np.stack([x, np.where(side > 0, 7.5, 28.5), z], axis=1)


def slid_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far from a trough's lowest sacks are: a cosine from any height (Huygens 1673)."""
    return np.asarray(course["outset"] * np.cos(course["rate"] * gone_s + course["phase"]))


def _auger(course: Course, gone_s: Floats) -> Floats:
    return swept(course, gone_s)


def _bucket(course: Course, gone_s: Floats) -> Floats:
    there = on_legs(risen_m(course, gone_s), course["side"])
    there[:, 1] += course["height"]
    return there


def _sack(course: Course, gone_s: Floats) -> Floats:
    return on_cycloid(slid_m(course, gone_s), course["side"], course["height"])


def _barrow(course: Course, gone_s: Floats) -> Floats:
    """Return where barrows are, which are pushed by steps round an oval of the fourth power."""
    steps = course["nods"] * np.sin(course["bent"] * gone_s + course["phase"])
    at = course["outset"] + (course["rate"] * gone_s + steps) / AXES_M[1]
    axes = np.array(AXES_M)[:, None] + course["side"]
    far = ((np.cos(at) / axes[0]) ** 4 + (np.sin(at) / axes[1]) ** 4) ** -0.25
    x, y = AMID_M[0] + far * np.cos(at), AMID_M[1] + far * np.sin(at)
    return np.stack([x, y, course["height"] + 0.4 * steps], axis=1)


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_auger, _bucket, _sack, _barrow)
"""Of kinds as in KINDS."""


def shifted(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["runs"] * into_s
    there = np.zeros((len(gone_s), 3))
    for number, way in enumerate(WAYS):
        own = course["craft"] == number
        there[own] = way({name: course[name][own] for name in COURSE}, gone_s[own])
    return there


class Docket:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `spout`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.count = len(table)
        self.spout: Integers = table["rx"].str.removeprefix("spout").to_numpy().astype(np.int64)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3503, what])

    def per_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def from_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def to_m(self) -> Floats:
        """Where spouts' radios are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    @cached_property
    def gone_s(self) -> Floats:
        """How long tags have gone, 0 of those that do not, in s [n]."""
        return self.course["runs"] * self.course["into_s"]

    def of(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.bool_)

    def past(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([what in some for some in self.table["obstacles"]], np.float64)

    def hidden_links(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        some = np.unique(self.link[self.table["obstacles"].str.len().gt(0).to_numpy()])
        count = min(max(1, round(share * (int(self.link.max()) + 1))), len(some))
        chosen = self.rng.choice(some, count, replace=False)
        return np.isin(self.link, chosen).astype(np.float64)

    def grows(self, tag_m: Floats | float, spout_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.to_m - self.from_m
        moved = way + np.asarray(spout_m) - np.asarray(tag_m)
        return np.asarray(np.sqrt((moved**2).sum(axis=1)) - np.sqrt((way**2).sum(axis=1)))

    def draws_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.grows(shifted(self.course, now_s + later_s) - shifted(self.course, now_s))
