"""The planetarium: planets, moons, ushers, comets and trolleys under a dome, and rows of these.

numpy and pandas alone. Coves about the dome have radios, which answer; tags call. Planets run on
an orrery's arms, by Kepler's law about the lamp; moons on wheels at arms that turn evenly; ushers
walk a round aisle, a step to either side; comets go to and fro on wires that hang as parabolas;
trolleys are hauled up the dome along its ribs.
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
HALL_M = (24.8, 24.8, 14.8)
MIDDLE_M: Floats = np.array([12.4, 12.4, 2.6])
"""Of the sphere that the dome is half of; below it the wall is upright."""
RADIUS_M, INSIDE_M = 12.0, 0.3  # of dome and wall; coves further in
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 6.4896  # channel 5
EVENING_S = 5.2 * 3600
TEETH_M = 0.94  # of a rack, from one tooth that is worn to the next
TRIPS_V = 221.0  # under which dimmers trip
SAZHEN_M = 2.1336
HEIGHTS_M: Floats = np.array([1.1, 3.4, 6.1, 1.5, 4.4, 8.2, 1.2, 5.5, 1.8, 7.3, 2.1, 1.3, 6.7, 2.9])
COVES = len(HEIGHTS_M)
PLASTIC = 0.7548776662466927  # x where x^-3 = x^-1 + 1
BEARINGS: Floats = np.asarray(2 * np.pi * ((0.2 + PLASTIC * np.arange(COVES)) % 1.0), np.float64)


def _coves() -> Floats:
    """Return where coves have their radios, in m [COVES, 3]: about the wall and up the dome."""
    up = (HEIGHTS_M - MIDDLE_M[2]).clip(0.0)
    out = np.sqrt((RADIUS_M - INSIDE_M) ** 2 - up**2)
    at = np.stack([np.cos(BEARINGS), np.sin(BEARINGS)]) * out + MIDDLE_M[:2, None]
    return np.column_stack([at.T, HEIGHTS_M])


COVES_M = _coves()
KINDS = {"planet": 3, "moon": 2, "usher": 3, "comet": 2, "trolley": 2}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"planet": "orrery", "moon": "orrery", "usher": "auditorium", "comet": "auditorium",
          "trolley": "dome"}  # fmt: skip
COURSE = ("kind", "bears", "out", "up", "sense", "rate", "size", "phase", "goes", "into_s")
"""How a tag goes, known to nobody; see `come_by`."""
WHEEL, TILT = -2.7, 0.3  # turns of a moon's wheel, each of the arm; of its plane
SAG_M, SPAN_M = 1.1, 8.0  # of wires amid them; half of these
SIDES = 7  # of an aisle that is not round
LAWS = {
    "felt-glued-over-covers": Law(("saturation", "logarithm", "power")),
    "breath-dampens-the-felt": Law(("parabola", "power")),
    "slide-tins-stacked-near": Law(("inverse square", "inverse", "power")),
    "programmes-piled-on-coves": Law(("linear", "power")),
    "valves-warm-since-switched-on": Law(("logarithm", "power", "saturation")),
    "fog-blown-about-tags": Law(("power", "logarithm", "saturation")),
    "worn-teeth-pass-on-racks": Law(("periodic",), TEETH_M, "m", grows=False),
    "dimmers-trip-at-low-mains": Law(("step",), 0.094, "m"),
    "haze-gathers-under-the-dome": Law(),
    "planets-driven-by-an-equant": Law(),
    "moons-slip-on-their-wheels": Law(),
    "ushers-walk-a-heptagon": Law(),
    "wires-sag-under-comets": Law(),
    "trolleys-roll-back": Law(),
    "places-read-off-a-tape-that-wows": Law(),
    "dome-swells-in-the-sun": Law(),
    "bearings-from-magnetic-north": Law(),
    "heights-taped-along-the-dome": Law(),
    "answers-smoothed-as-they-come": Law(),
    "weak-answers-told-as-the-last": Law(),
    "cove-leant-on-by-a-ladder": Law(("position",), 0.55, "m", devices=("cove6",)),
    "coves-wired-crosswise": Law(("swap",), devices=("cove3", "cove8")),
    "sazhens-from-one-cove": Law(("unit",), 1 / SAZHEN_M, "1", grows=False, devices=("cove10",)),
}
"""What nobody's library has."""
Course = dict[str, Floats]


@dataclass(frozen=True)
class Fee:
    """What rows [n] pay: `late_m` of range; dB of all, first paths, noise and counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def clear_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from floor, wall or dome, in m [n]; < 0 outside."""
    off = at - MIDDLE_M
    out = np.sqrt((off[:, :2] ** 2).sum(axis=1) + off[:, 2].clip(0.0) ** 2)
    return np.asarray(np.minimum(RADIUS_M - out, at[:, 2]))


def _about(bearing: Floats, out: Floats, up: Floats) -> Floats:
    """Return places by bearings about the middle, in m [n, 3]."""
    east, north = (MIDDLE_M[k] + out * of(bearing) for k, of in enumerate((np.cos, np.sin)))
    return np.column_stack([east, north, up + 0 * bearing])


def anomaly(mean: Floats, round_by: Floats) -> Floats:
    """Return eccentric anomalies in radians, by mean ones and eccentricities [n] (Kepler 1609)."""
    made = mean + round_by * np.sin(mean)
    for _ in range(9):
        off = made - round_by * np.sin(made) - mean
        made = made - off / (1 - round_by * np.cos(made))
    return np.asarray(made)


def orbits(course: Course, gone_s: Floats, equant: float = 0.0) -> Floats:
    """Return where planets are, in m [n, 3]; by a part where Ptolemy's equant has these.

    There a circle's middle is off the lamp as Kepler's is, and turns evenly as seen from as far
    beyond.
    """
    out, off = course["out"], course["size"]
    mean = course["bears"] + course["sense"] * course["rate"] * gone_s
    half, turn = anomaly(mean, off), mean + np.arcsin(off * np.sin(mean))
    along = np.cos(half) - off + equant * (np.cos(turn) - np.cos(half))
    aside = np.sqrt(1 - off**2) * np.sin(half)
    aside = out * (aside + equant * (np.sin(turn) - aside))
    east, north = np.cos(course["phase"]), np.sin(course["phase"])
    flat = np.stack([out * along * east - aside * north, out * along * north + aside * east])
    return np.column_stack([flat.T + MIDDLE_M[:2], course["up"] + 0 * mean])


def wheels(course: Course, gone_s: Floats, slips: float = 0.0) -> Floats:
    """Return where moons are, in m [n, 3]; wheels turn by a part less than told."""
    arm = course["sense"] * course["rate"] * gone_s
    wheel = course["phase"] + WHEEL * (1 - slips) * arm
    made = _about(course["bears"] + arm, course["out"], course["up"])
    turned = np.stack([np.cos(wheel), np.sin(wheel), TILT * np.sin(wheel)])
    return np.asarray(made + (course["size"] * turned).T)


def walks(course: Course, gone_s: Floats, straight: float = 0.0) -> Floats:
    """Return where ushers are, in m [n, 3]; by a part on a heptagon's sides within the aisle."""
    bearing = course["bears"] + course["sense"] * course["rate"] * gone_s
    side = 2 * np.pi / SIDES
    chord = np.cos(side / 2) / np.cos((bearing % side) - side / 2)
    steps = course["size"] * np.sin(course["phase"] * gone_s)
    return _about(bearing, course["out"] * (1 + straight * (chord - 1)) + steps, course["up"])


def slides(course: Course, gone_s: Floats, deeper: float = 0.0) -> Floats:
    """Return where comets are, in m [n, 3]: on wires, which sag more by a part."""
    part = course["size"] * np.sin(course["phase"] + course["rate"] * gone_s)
    sag = SAG_M * (1 + deeper) * (1 - (part / SPAN_M) ** 2)
    east, north = np.cos(course["bears"]), np.sin(course["bears"])
    at = np.stack([part * east - course["out"] * north, part * north + course["out"] * east])
    return np.column_stack([at.T + MIDDLE_M[:2], course["up"] - sag])


def climbs(course: Course, gone_s: Floats, back: float = 0.0) -> Floats:
    """Return where trolleys are, in m [n, 3]: up ribs; they roll back by the root of the time."""
    high = course["phase"] + course["sense"] * course["rate"] * gone_s - back * np.sqrt(gone_s)
    out = course["out"]
    return _about(course["bears"], out * np.cos(high), MIDDLE_M[2] + out * np.sin(high))


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (orbits, wheels, walks, slides, climbs)
"""Of kinds as in KINDS."""


def come_by(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = (course["goes"] * into_s).clip(0.0)
    there = np.empty((len(gone_s), 3))
    for kind, way in enumerate(WAYS):
        own = course["kind"] == kind
        if own.any():
            there[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return there


class Seating:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `cove`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.cove: Integers = np.array([int(one[4:]) for one in table["rx"]], np.int64)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([5203, what, self.case])

    def each(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return draws(int(self.link.max()) + 1).astype(np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def cove_m(self) -> Floats:
        """Where coves' radios are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def of(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.course["kind"] == list(KINDS).index(kind))

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def eclipsed(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        first = np.unique(self.link, return_index=True)[1]
        could = np.flatnonzero(self.table["obstacles"].iloc[first].map(bool))
        count = min(max(round(share * len(first)), 1), len(could))
        return np.isin(self.link, self.rng.choice(could, count, replace=False)).astype(np.float64)

    def longer_m(self, tag_off: Floats | float, cove_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        run = self.tag_m - self.cove_m
        grown = np.linalg.norm(run + tag_off - cove_off, axis=1) - np.linalg.norm(run, axis=1)
        return np.asarray(grown)

    def wanders_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now_s = self.course["into_s"]
        there = come_by(self.course, now_s + later_s) - come_by(self.course, now_s)
        return self.longer_m(there)
