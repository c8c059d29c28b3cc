"""The lighthouse: a tower, a cottage, an oil tank, who serves there, and rows of these.

numpy and pandas alone. Tower and cottage stand on a walled rock; cressets, radios at fixed places,
hear tags. Keepers pace rounded squares; tenders drift until they lie still; gulls wheel along
trochoids; cans are hoisted and sway; lenses turn unevenly; donkeys wind in a capstan's rope.
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
ROCK_M = (38.0, 27.0, 14.0)
TOWER_M = (12.0, 14.0, 2.6)
"""Across, along and radius of the tower's wall, that is as high as all there is."""
COTTAGE_M: Floats = np.array([[23.0, 9.5], [32.0, 16.5]])
"""Its nearest and farthest corner; its wall towards the sea is all window."""
OIL_M = (17.5, 6.0, 1.1)  # across, along and radius of an oil tank
NIGHT_S = 13.0 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 3.9936  # channel 2
CRESSETS_M: Floats = np.array([
    [0.6, 5.0, 3.0], [0.5, 13.5, 5.2], [0.7, 22.4, 2.4], [6.2, 26.4, 4.4], [7.4, 0.6, 2.7],
    [9.3, 10.6, 8.4], [15.4, 16.6, 11.2], [14.2, 0.5, 5.8], [13.6, 26.5, 2.5], [20.4, 0.6, 3.3],
    [19.8, 12.6, 4.0], [21.2, 26.4, 6.4], [27.0, 7.4, 2.3], [27.6, 19.6, 5.0], [31.0, 0.6, 6.8],
    [30.4, 26.5, 3.2], [37.4, 6.4, 4.6], [37.5, 14.2, 2.6], [37.4, 21.8, 7.6],
])  # fmt: skip
CRESSETS = len(CRESSETS_M)
CALLINGS = {"keeper": 3, "tender": 2, "gull": 3, "hoist": 2, "lens": 2, "donkey": 2}
"""How many tags there are of each calling."""
TAGS = tuple(f"{calling}{k}" for calling, count in CALLINGS.items() for k in range(count))
HAUNTS = {"keeper": "gallery", "tender": "landing", "gull": "cliff", "hoist": "derrick",
          "lens": "lantern", "donkey": "capstan"}  # fmt: skip
COURSE = ("calling", "heart_x", "heart_y", "heart_z", "heads", "rate", "reach", "bend", "phase",
          "stirs", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `gone_by`."""
RUNG_M = 0.31  # between rungs of the lantern's ladder
RINGS_KM = 7.0  # of sight, under which the fog bell's relay is closed
FATHOM_M = 1.8288
LAWS = {
    "salt-crusts-on-cressets": Law(("saturation", "logarithm", "power")),
    "verdigris-creeps-over-lanterns": Law(("logarithm", "power", "saturation")),
    "guano-thickens-on-ledges": Law(("linear", "power")),
    "mercury-of-the-lens-bath-dwindles": Law(("power", "logarithm", "saturation")),
    "boom-of-the-boat-derrick-close": Law(("inverse square", "inverse", "power")),
    "swell-lifts-before-the-landing": Law(("power", "parabola")),
    "siren-off-its-best-pressure": Law(("parabola",)),
    "rungs-of-the-ladder-pass": Law(("periodic",), RUNG_M, "m", grows=False),
    "fog-bells-relay-closes": Law(("step",), 0.088, "m"),
    "spray-hangs-over-the-weather-side": Law(),
    "warm-draught-rises-in-the-tower": Law(),
    "beam-heats-ways-that-it-sweeps": Law(),
    "tide-gauge-sticks-in-its-well": Law(),
    "keepers-cut-their-corners": Law(),
    "tenders-carry-their-way-longer": Law(),
    "gulls-wheel-wider-than-told": Law(),
    "cans-sway-wider-on-the-hoist": Law(),
    "lenses-stick-twice-a-turn": Law(),
    "donkeys-wind-rope-in-sooner": Law(),
    "places-told-by-a-losing-chronometer": Law(),
    "heights-sounded-by-a-stretched-line": Law(),
    "chart-of-the-rock-sheared": Law(),
    "tower-bends-in-the-gale": Law(),
    "rock-heaves-with-the-tide": Law(),
    "answers-late-until-the-clock-is-wound": Law(),
    "answers-booked-by-dead-reckoning": Law(),
    "answers-lean-to-the-watchs-first": Law(),
    "heaving-line-stretches-by-its-own-weight": Law(),
    "knots-of-the-line-counted-too-large": Law(),
    "vernier-read-from-its-wrong-end": Law(),
    "cresset-bent-by-a-sea": Law(("position",), 0.47, "m", devices=("cresset5",)),
    "cressets-listed-in-each-others-place": Law(("swap",), devices=("cresset2", "cresset12")),
    "fathoms-from-one-cresset": Law(("unit",), 1 / FATHOM_M, "1", grows=False,
                                    devices=("cresset10",)),
}  # fmt: skip
"""What nobody's library has."""
Course = dict[str, Floats]
SQUARE, UNEVEN, SPIN_UP_S, SWAYS = 0.11, 0.12, 1.6, 0.62
"""Of rounded squares; radians of lenses; of hoists, until they run; radians a second of cans."""


@dataclass(frozen=True)
class Dues:
    """What rows [n] owe: m of range, dB of levels, of first paths, of noise, of counts."""

    more_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def clear_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from outer walls, ground, sky and oil tank, in m [n].

    < 0 outside, and within the tank.
    """
    outer = np.minimum(at, np.array(ROCK_M) - at).min(axis=1)
    east, north, radius = OIL_M
    return np.asarray(np.minimum(outer, np.hypot(at[:, 0] - east, at[:, 1] - north) - radius))


def _placed(course: Course, plane: NDArray[np.complex128], up: Floats | float) -> Floats:
    """Return places off where courses begin, in m [n, 3]; ahead is real, aside imaginary."""
    turned = plane * np.exp(1j * course["heads"])
    here = (course["heart_x"] + turned.real, course["heart_y"] + turned.imag,
            course["heart_z"] + up)  # fmt: skip
    return np.stack(np.broadcast_arrays(*here), axis=1)


def paces(course: Course, gone_s: Floats, rounder: float = 0.0) -> Floats:
    """Return where keepers are, in m [n, 3]: on squares whose corners are round, or cut more."""

    def at(angle: Floats) -> NDArray[np.complex128]:
        corner = SQUARE * (1 - rounder)
        return np.asarray(course["reach"] * (np.exp(1j * angle) + corner * np.exp(-3j * angle)))

    return _placed(course, at(course["phase"] + course["rate"] * gone_s) - at(course["phase"]), 0.0)


def drifts(course: Course, gone_s: Floats, longer: float = 0.0) -> Floats:
    """Return where tenders are, in m [n, 3]: from `rate` they slow down in `reach` s, or longer.

    They set aside by `bend` of the way that they have made.
    """
    slows_s = course["reach"] * (1 + longer)
    way = -course["rate"] * slows_s * np.expm1(-gone_s / slows_s)
    return _placed(course, way * (1 + 1j * course["bend"]), 0.0)


def wheels(course: Course, gone_s: Floats, wider: float = 0.0) -> Floats:
    """Return where gulls are, in m [n, 3]: on trochoids `reach` m wide, or wider by a part."""
    turns = course["phase"] + course["bend"] * gone_s
    round_ = course["reach"] * (1 + wider) * (np.exp(1j * turns) - np.exp(1j * course["phase"]))
    return _placed(course, course["rate"] * gone_s + round_, 0.25 * round_.imag)


def hoisted(course: Course, gone_s: Floats, wider: float = 0.0) -> Floats:
    """Return where cans are, in m [n, 3]: up ever faster to `rate`, swaying `reach` m aside."""
    up = course["rate"] * (gone_s + SPIN_UP_S * np.expm1(-gone_s / SPIN_UP_S))
    sways = np.sin(SWAYS * gone_s + course["phase"]) - np.sin(course["phase"])
    return _placed(course, (1 + wider) * course["reach"] * sways * (1 + 0.3j), up)


def revolves(course: Course, gone_s: Floats, sticks: float = 0.0) -> Floats:
    """Return where marks on lenses are, in m [n, 3]: round, faster and slower twice a turn."""
    even = course["phase"] + course["rate"] * gone_s
    uneven = (UNEVEN + sticks) * (np.sin(2 * even) - np.sin(2 * course["phase"]))
    return _placed(course, course["reach"] * np.exp(1j * (even + uneven)), 0.0)


def winds(course: Course, gone_s: Floats, sooner: float = 0.0) -> Floats:
    """Return where donkeys are, in m [n, 3]: on spirals inward, e-folds of `bend` a radian."""
    turned = course["rate"] * gone_s
    arm = course["reach"] * np.exp(-(1 + sooner) * course["bend"] * turned)
    return _placed(course, arm * np.exp(1j * (course["phase"] + turned)), 0.0)


WAYS = (paces, drifts, wheels, hoisted, revolves, winds)


def gone_by(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["stirs"] * into_s.clip(0.0)
    made = np.zeros((len(gone_s), 3))
    for number, way in enumerate(WAYS):
        own = np.flatnonzero(course["calling"] == number)
        if own.size:
            made[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return made


class Entries:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `tag`, `cresset` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare, self.rows = table, case, rng, rare, len(table)
        self.tag: Integers = table["tx"].map(TAGS.index).to_numpy(np.int64)
        self.cresset: Integers = table["rx"].str.slice(len("cresset")).to_numpy(np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"], sort=True)[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9303, what, self.case])

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
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def cresset_m(self) -> Floats:
        """Where cressets are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def are(self, calling: str) -> Integers:
        """Return which rows are of tags of a calling."""
        return np.flatnonzero(self.table["tx"].str.startswith(calling))

    def met(self, what: str) -> Floats:
        """Return how many such things straight ways go through [n]."""
        return np.asarray([[*some].count(what) for some in self.table["obstacles"]], np.float64)

    def cut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        behind = np.unique(self.link[self.table["obstacles"].map(len).to_numpy() > 0])
        most = min(len(behind), max(1, round(share * (int(self.link.max()) + 1))))
        return np.isin(self.link, self.rng.permutation(behind)[:most]).astype(np.float64)

    def grows_m(self, tag_off: Floats | float, cresset_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        way = self.tag_m - self.cresset_m
        other = way + tag_off - cresset_off
        return np.asarray(np.sqrt((other**2).sum(axis=1)) - np.sqrt((way**2).sum(axis=1)))

    def bears_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now = self.course["into_s"]
        return self.grows_m(gone_by(self.course, now + later_s) - gone_by(self.course, now))
