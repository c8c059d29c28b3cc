"""The colliery: skips, tubs, booms and miners' lamps in an underground hall, and rows of these.

numpy and pandas alone. Props with radios stand along the hall's sides and hang from bolts in its
roof. Skips are wound up and down an incline, tubs run on rails that meander between pillars, booms
of a drilling jumbo roll over about their own axes, and lamps are worn by miners who walk.
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
HALL_M = (62.0, 44.0, 13.0)
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 4.4928  # channel 3
SHIFT_S = 7.0 * 3600
IDLER_M = 1.12  # from one idler of the conveyor's belt to the next
FIREDAMP_PCT = 1.25  # of methane, from which drives are cut off
LACHTER_M = 1.9817  # of Freiberg
FOOT_M, SLOPE_RAD = (10.0, 16.5, 0.6), np.radians(23.0)  # of the incline, where rails begin
TRACKS_M = 1.1  # by which either track of it is off its middle
INCLINE_M, WOUND_S = 24.0, 9.0  # how long it is, and how long winding takes
MEANDER_M, MOST_RAD = 38.0, 0.9  # of rails: how long a meander is, how far it turns off
RAILS_M = (5.0, 28.5, 70.0)  # where rails begin, across; how long they are
JUMBO_M = (47.0, 11.5, 2.0)  # where booms are hinged
YAWS_RAD, PITCH_RAD = (0.35, -0.5), 0.22  # how booms point
PROPS_M: Floats = np.array(
    [(4.5, 5.0, 2.1), (16.0, 3.2, 3.4), (29.5, 4.4, 1.6), (43.0, 2.8, 2.8), (57.5, 6.0, 1.9),
     (58.5, 20.5, 4.2), (56.0, 37.5, 2.4), (41.5, 41.0, 3.6), (25.0, 40.2, 1.4), (8.0, 38.5, 2.9),
     (20.5, 22.0, 11.2), (40.0, 21.0, 11.8)]
)  # fmt: skip
"""Where props have their radios, in m [PROPS, 3]; the last two hang from the roof."""
PROPS = len(PROPS_M)
KINDS = {"skip": 2, "tub": 3, "boom": 2, "lamp": 4}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"skip": "incline", "tub": "haulage", "boom": "face", "lamp": "manway"}
COURSE = ("kind", "begins", "lane", "tall", "pace", "sways", "beat", "phase", "goes", "into_s")
"""How a tag goes, known to nobody; see `carried`."""
LAWS = {
    "stone-dust-lies-on-props": Law(("saturation", "logarithm", "power")),
    "roof-drips-on-covers": Law(("power", "parabola")),
    "conveyor-runs-close-by": Law(("inverse", "power", "inverse square")),
    "covers-soak-since-they-were-hung": Law(("logarithm", "power", "saturation")),
    "chocks-stand-beside": Law(("linear", "power")),
    "belt-idlers-pass": Law(("periodic",), IDLER_M, "m", grows=False),
    "drives-cut-off-at-firedamp": Law(("step",), 0.097, "m"),
    "haze-that-draught-clears": Law(),
    "winding-rope-stretches": Law(),
    "tubs-hunt-on-their-rails": Law(),
    "drilling-shakes-booms": Law(),
    "roof-comes-down-amid": Law(),
    "traverse-turns-at-each-station": Law(),
    "prop-rammed-by-a-tub": Law(("position",), 0.46, "m", devices=("prop8",)),
    "props-wired-crosswise": Law(("swap",), devices=("prop1", "prop6")),
    "lachters-from-one-prop": Law(("unit",), 1 / LACHTER_M, "1", grows=False, devices=("prop4",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Burden:
    """What rows [n] bear: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def _rails() -> Floats:
    """Return along, x, y and heading of the rails, each fiftieth of a metre [4, k].

    They meander as rivers do, whose heading is a sine of how far one has come (Langbein and
    Leopold 1966).
    """
    along = np.linspace(0.0, RAILS_M[2], 3501)
    heading = MOST_RAD * np.sin(2 * np.pi * along / MEANDER_M)
    x, y = (
        np.append(0.0, np.cumsum(0.5 * (turn[1:] + turn[:-1]) * along[1]))
        for turn in (np.cos(heading), np.sin(heading))
    )
    return np.stack([along, x + RAILS_M[0], y - 0.5 * np.ptp(y) + RAILS_M[1], heading])


RAILS = _rails()


def on_rails(along_m: Floats, aside_m: Floats | float, tall_m: Floats | float) -> Floats:
    """Return places so far along rails, to the left of these, and above them, in m [n, 3]."""
    x, y, heading = (np.interp(along_m, RAILS[0], one) for one in RAILS[1:])
    left = np.zeros(len(x)) + aside_m
    return np.stack(
        [x - left * np.sin(heading), y + left * np.cos(heading), np.zeros(len(x)) + tall_m], axis=1
    )


def wound_m(since_s: Floats) -> Floats:
    """Return how far skips have come since winding began in m [n]: by a cycloid's law."""
    part = (since_s / WOUND_S).clip(0.0, 1.0)
    return INCLINE_M * (part - np.sin(2 * np.pi * part) / (2 * np.pi))


def on_incline(up_m: Floats, lane: Floats, tall_m: Floats) -> Floats:
    """Return places so far up the incline on either track, square above it, in m [n, 3]."""
    x = FOOT_M[0] + up_m * np.cos(SLOPE_RAD) - tall_m * np.sin(SLOPE_RAD)
    z = FOOT_M[2] + up_m * np.sin(SLOPE_RAD) + tall_m * np.cos(SLOPE_RAD)
    return np.stack([x, FOOT_M[1] + TRACKS_M * lane, z], axis=1)


def up_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far up the incline skips are in m [n]: one goes up while the other comes down."""
    come = wound_m(course["begins"] + gone_s)
    bobs = course["sways"] * np.cos(course["beat"] * gone_s + course["phase"])
    return np.where(course["lane"] > 0, come, INCLINE_M - come) + bobs
    return np.asarray(np.where(course["lane"] > 0, come, INCLINE_M - come) + bobs)


def along_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far along rails tubs are in m [n], which couplings pull and push."""
    jerks = np.sin(course["beat"] * gone_s + course["phase"]) - np.sin(course["phase"])
    return np.asarray(course["begins"] + course["pace"] * gone_s + course["sways"] * jerks)


def _skip(course: Course, gone_s: Floats) -> Floats:
    return on_incline(up_m(course, gone_s), course["lane"], course["tall"])


def _tub(course: Course, gone_s: Floats) -> Floats:
    return on_rails(along_m(course, gone_s), 0.0, course["tall"])


def _boom(course: Course, gone_s: Floats) -> Floats:
    """Return where booms' heads are, which roll over about their booms, and are fed on."""
    yaw = np.where(course["lane"] > 0, *YAWS_RAD)
    turn = course["pace"] * gone_s + course["phase"]
    out = course["begins"] + 0.5 * course["sways"] * np.tanh(gone_s / 2.0)
    side, up = course["tall"] * np.cos(turn), course["tall"] * np.sin(turn)
    level = out * np.cos(PITCH_RAD) - up * np.sin(PITCH_RAD)
    return np.stack(
        [
            JUMBO_M[0] + level * np.cos(yaw) - side * np.sin(yaw),
            JUMBO_M[1] + level * np.sin(yaw) + side * np.cos(yaw),
            JUMBO_M[2] + out * np.sin(PITCH_RAD) + up * np.cos(PITCH_RAD),
        ],
        axis=1,
    )


def _lamp(course: Course, gone_s: Floats) -> Floats:
    """Return where lamps are: heads sway once, and nod twice, with every other step."""
    turn = course["beat"] * gone_s + course["phase"]
    nods = 0.3 * course["sways"] * np.cos(2 * turn)
    return np.stack(
        [
            course["begins"] + course["pace"] * gone_s,
            course["lane"] + course["sways"] * np.sin(turn),
            course["tall"] + nods,
        ],
        axis=1,
    )


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_skip, _tub, _boom, _lamp)
"""Of kinds as in KINDS."""


def carried(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * into_s
    there = np.zeros((len(gone_s), 3))
    for number, way in enumerate(WAYS):
        own = course["kind"] == number
        there[own] = way({name: course[name][own] for name in COURSE}, gone_s[own])
    return there


class Tally:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `prop`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.prop: Integers = table["rx"].str.removeprefix("prop").to_numpy().astype(np.int64)
        self.tag: Integers = np.array([TAGS.index(name) for name in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3403, what])

    def by_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def sends(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def stands(self) -> Floats:
        """Where props' radios are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    @cached_property
    def gone_s(self) -> Floats:
        """How long tags have gone, 0 of those that do not, in s [n]."""
        return self.course["goes"] * self.course["into_s"]

    def are(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.bool_)

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def cut_off(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        some = self.table["obstacles"].str.len().gt(0).to_numpy()
        lots = self.rng.permutation(np.unique(self.link[some]))
        count = min(max(1, round(share * (int(self.link.max()) + 1))), len(lots))
        return np.isin(self.link, lots[:count]).astype(np.float64)

    def lengthens(self, tag_m: Floats | float, prop_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.sends - self.stands
        off = np.asarray(tag_m) - np.asarray(prop_m)
        return np.asarray(np.linalg.norm(way + off, axis=1) - np.linalg.norm(way, axis=1))

    def recedes_by(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.lengthens(carried(self.course, now_s + later_s) - carried(self.course, now_s))
