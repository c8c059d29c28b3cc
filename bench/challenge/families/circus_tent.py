"""The circus: fliers, spinners, cyclists and walkers below a big top, and rows of these.

numpy and pandas alone. Performers' tags are heard by radios on poles of the tent. Fliers swing on
trapezes; spinners go round on straps, by ellipses that turn (Airy 1851); cyclists leave rosettes in
the ring; walkers go along wires step by step.
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
TENT_M = (44.0, 36.0, 13.5)
POLES_M: Floats = np.array([
    (15.6, 12.4, 9.8), (28.4, 12.4, 3.1), (28.4, 23.6, 10.6), (15.6, 23.6, 4.4),
    (6.2, 9.0, 2.6), (11.0, 2.6, 4.9), (22.3, 1.4, 3.4), (34.1, 3.2, 5.3),
    (40.8, 13.7, 2.8), (38.6, 27.4, 4.7), (24.6, 34.3, 3.7), (8.4, 30.1, 5.6),
])  # fmt: skip
"""Where poles have their radios, in m: four king poles, and eight quarter poles round these."""
POLES = len(POLES_M)
KINDS = {"flier": 3, "spinner": 3, "cyclist": 3, "walker": 2}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"flier": "trapezes", "spinner": "straps", "cyclist": "ring", "walker": "wire"}
COURSE = (
    "kind", "hung_x", "hung_y", "hung_z", "aim", "reach", "throw", "girth", "rate", "phase",
    "goes", "into_s",
)  # fmt: skip
"""How a tag goes, known to nobody; see `shown`."""
GRAVITY = 9.81  # m/s2
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 6.4896  # channel 5
DAY_S = 9.0 * 3600
PANEL_M = 2.9  # of the ring's fence
LACED_PCT = 61.0  # from which sides count as laced up
ARSHIN_M = 0.7112  # of Tula: sixteen vershoks
WIRE_M, DIP_M = 26.0, 0.55  # a wire's length; how much lower it is amid by itself
LAWS = {
    "chalk-dusts-the-poles": Law(("saturation", "logarithm", "power")),
    "rain-soaks-the-canvas": Law(("power", "parabola")),
    "lions-cage-close-by": Law(("inverse", "inverse square", "power")),
    "rosin-on-tags": Law(("logarithm", "power", "saturation")),
    "crowd-leans-in": Law(("linear", "power")),
    "fence-panels-pass": Law(("periodic",), PANEL_M, "m", grows=False),
    "sides-laced-up": Law(("step",), 0.091, "m"),
    "smoke-under-lamps": Law(),
    "trapezes-ropes-give": Law(),
    "wire-dips-under-walkers": Law(),
    "gusts-rack-their-poles": Law(),
    "poles-bow-under-canvas": Law(),
    "pole-struck-by-a-lorry": Law(("position",), 0.45, "m", devices=("pole1",)),
    "poles-wired-crosswise": Law(("swap",), devices=("pole4", "pole9")),
    "arshins-from-one-pole": Law(("unit",), 1 / ARSHIN_M, "1", grows=False, devices=("pole10",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Trick:
    """What rows [n] bear: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def _below(course: Course, along: Floats, across: Floats, up: Floats) -> Floats:
    """Return places so far along, across and above what courses hang from, in m [n, 3]."""
    turn = np.exp(1j * course["aim"]) * (along + 1j * across)
    return np.stack(
        [course["hung_x"] + turn.real, course["hung_y"] + turn.imag, course["hung_z"] + up], axis=1
    )


def swing_rad(course: Course, gone_s: Floats) -> Floats:
    """Return how far from upright trapezes are, in radians [n].

    Wide swings are slower by a sixteenth of their square, and have a little of thrice their pitch.
    """
    wide = course["throw"]
    pitch = np.sqrt(GRAVITY / course["reach"]) * (1 - wide**2 / 16)
    turn = pitch * gone_s + course["phase"]
    return np.asarray(wide * np.cos(turn) + wide**3 / 192 * np.cos(3 * turn))


def _flier(course: Course, gone_s: Floats) -> Floats:
    angle, long = swing_rad(course, gone_s), course["reach"]
    return _below(course, long * np.sin(angle), np.zeros_like(gone_s), -long * np.cos(angle))


def _spinner(course: Course, gone_s: Floats) -> Floats:
    """Return where spinners are: on an ellipse that turns by 3/8 of its area by its strap's."""
    long, wide, thin = course["reach"], course["throw"], course["girth"]
    pitch = np.sqrt(GRAVITY / long)
    turn = pitch * gone_s + course["phase"]
    at = wide * np.cos(turn) + 1j * thin * np.sin(turn)
    at = at * np.exp(0.375j * wide * thin / long**2 * pitch * gone_s)
    return _below(course, at.real, at.imag, -np.sqrt(long**2 - np.abs(at) ** 2))


def _cyclist(course: Course, gone_s: Floats) -> Floats:
    """Return where cyclists are: on a circle about the ring's middle, and on loops the other way.

    `reach` is how wide the circle is and `throw` the loops are; `girth` how many loops there are.
    """
    turn = course["rate"] * gone_s
    at = course["reach"] * np.exp(1j * (turn + course["phase"]))
    at = at + course["throw"] * np.exp(-1j * ((course["girth"] - 1) * turn - course["phase"]))
    return _below(course, at.real, at.imag, np.zeros_like(gone_s))


def walked_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far walkers have come in m [n]: between steps they all but stand."""
    turn = course["rate"] * gone_s + course["phase"]
    swings = (np.sin(turn) - np.sin(course["phase"])) / course["rate"]
    return np.asarray(course["reach"] * (gone_s - 0.85 * swings))


def along_wire(course: Course, gone_s: Floats) -> Floats:
    """Return which part of their wire walkers have behind them [n]."""
    return np.asarray((course["girth"] + walked_m(course, gone_s)) / WIRE_M)


def _walker(course: Course, gone_s: Floats) -> Floats:
    """Return where walkers are: from `girth` m on along their wire, leaning to and fro."""
    part = along_wire(course, gone_s)
    lean = course["throw"] * np.sin(0.5 * course["rate"] * gone_s + course["phase"])
    return _below(course, part * WIRE_M, lean, -4 * DIP_M * part * (1 - part))


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_flier, _spinner, _cyclist, _walker)
"""Of kinds as in KINDS."""


def shown(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * into_s
    found = np.zeros((len(into_s), 3))
    for number, way in enumerate(WAYS):
        own = course["kind"] == number
        found[own] = way({name: course[name][own] for name in COURSE}, gone_s[own])
    return found


class Act:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `pole`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.pole: Integers = np.array([int(name[4:]) for name in table["rx"]], np.int64)
        self.tag: Integers = np.array([TAGS.index(name) for name in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2903, what])

    def by_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def post(self) -> Floats:
        """Where poles' radios are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def gone_s(self) -> Floats:
        """Return how long tags have gone on their courses, in s [n]."""
        return np.asarray(self.course["goes"] * self.course["into_s"])

    def are(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.bool_)

    def meets(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def cut_off(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        hidden = np.unique(self.link[[bool(some) for some in self.table["obstacles"]]])
        count = max(1, min(round(share * len({*self.link})), len(hidden)))
        return np.isin(self.link, self.rng.permutation(hidden)[:count]).astype(np.float64)

    def gains(self, tag_m: Floats | float, pole_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.there - self.post
        off = np.asarray(tag_m) - np.asarray(pole_m)
        return np.asarray(np.linalg.norm(way + off, axis=1) - np.linalg.norm(way, axis=1))

    def outgrows(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.gains(shown(self.course, now_s + later_s) - shown(self.course, now_s))
