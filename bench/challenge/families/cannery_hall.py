"""The cannery: belts, a spiral, carts, what nobody knows of them, and rows that effects are put on.

numpy and pandas alone. Pucks with tins run round two oval belts or up a spiral, carts with baskets
are pushed along a lane with a bend; brackets under the roof range them as they pass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Places = NDArray[np.intp]
HALL_M = (31.0, 18.5, 4.9)
BRACKETS_M: Floats = np.array(
    [(1.2, 2.0, 3.1), (6.4, 9.4, 3.9), (13.6, 9.1, 3.4), (1.0, 15.7, 2.7), (12.9, 17.4, 3.6),
     (17.6, 6.2, 2.6), (19.0, 17.6, 3.3), (18.6, 9.2, 4.1), (26.6, 15.6, 2.9), (29.8, 6.1, 3.5),
     (23.4, 0.9, 2.4)]
)  # fmt: skip
TAGS = (*(f"tin{k}" for k in range(8)), *(f"cart{k}" for k in range(4)))
TINS = 8
OVALS = ((9.5, 5.6, 4.0, 2.3, 0.98), (9.0, 13.4, 5.0, 1.7, 1.62))
"""Middles, half the length of straights, radius of bends, height of tags, all in m."""
SPIRAL_M = (22.5, 12.8, 0.55)  # axis, and the height of its foot
TURN_M, PITCH_M = 1.35, 0.36  # radius, and what a turn climbs
LANE_M = (14.5, 2.2, 1.35)  # where carts begin, and how high their tags are
AHEAD_M, BEND_M = 10.9, 1.8  # of a lane: until its bend, and the bend's radius
RETORTS_M: Floats = np.array([(22.5, 12.8), (28.0, 2.4), (16.9, 13.9), (5.5, 16.9)])
"""What is of steel and high: the spiral's tower and retorts."""
BETWEEN = {"wood": (0.3, 1.99, 2.2), "concrete": (0.22, 5.24, 5.6), "glass": (0.04, 6.31, 1.5)}
"""Pallets with boxes, pillars, windows of the laboratory: m, permittivity, dB of each."""
COURSE = ("loop", "begun_m", "speed_mps", "surge", "beat_s", "phase_rad", "since_s", "poll")
"""What moves a lot, known to nobody."""
PPM_M = 149.896229  # metres for each second of a reply and millionth
WAVE_M = 0.299792458 / 3.9936  # channel 2
SHIFT_S = 7.75 * 3600
CHAIN_M = 1.92  # of a belt for each turn of its sprocket
LAWS = {
    "brine-on-lids": Law(("saturation", "logarithm", "power")),
    "tins-crowd": Law(("power", "parabola")),
    "sprocket-wobbles": Law(("periodic",), CHAIN_M, "m", grows=False),
    "guard-let-down": Law(("step",), 0.101, "m"),
    "oil-on-domes": Law(("logarithm", "power", "saturation")),
    "ice-heaped": Law(("linear", "power")),
    "air-knives-slow": Law(("inverse", "power", "inverse square")),
    "pucks-ride-outside": Law(),
    "play-in-the-filter": Law(),
    "bracket-hit-by-a-fork": Law(("position",), 0.39, "m", devices=("bracket4",)),
    "brackets-relettered": Law(("swap",), devices=("bracket2", "bracket7")),
    "shaku-from-one-bracket": Law(("unit",), 3.3, "1", grows=False, devices=("bracket9",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Harm:
    """What goes wrong at rows [n]: metres, dB of all that comes, of its first path, and of noise.

    `symbols_db`: of how many are added up.
    """

    metres: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    symbols_db: Floats | float = 0.0


def moved_on(course: dict[str, Floats], at_s: Floats) -> Floats:
    """Return where along loops lots are in m at times [n]: belts run faster and slower by turns."""
    turn = 2 * np.pi / course["beat_s"]
    sway = np.sin(turn * at_s + course["phase_rad"]) - np.sin(course["phase_rad"])
    return np.asarray(
        course["begun_m"] + course["speed_mps"] * (at_s + course["surge"] / turn * sway)
    )


def place(loop: Floats, along_m: Floats) -> Floats:
    """Return where tags are [n, 3], in m, so far along loops: two ovals, a spiral, a lane."""
    ways = [*(_oval(along_m, *oval) for oval in OVALS), _spiral(along_m), _lane(along_m)]
    return np.asarray(np.choose(loop.astype(np.intp)[:, None], ways))


def _oval(along_m: Floats, x: float, y: float, half: float, bend: float, high: float) -> Floats:
    """Return places on two straights along x and two half circles [n, 3]."""
    part = along_m % (4 * half + 2 * np.pi * bend)
    back = part >= 2 * half + np.pi * bend  # the other half is the same, turned round
    part = part - back * (2 * half + np.pi * bend)
    angle = np.maximum(part - 2 * half, 0.0) / bend
    out = np.minimum(part, 2 * half) - half + bend * np.sin(angle)
    sign = np.where(back, -1.0, 1.0)
    return np.stack([x + sign * out, y - sign * bend * np.cos(angle), 0 * part + high], axis=1)


def _spiral(along_m: Floats) -> Floats:
    """Return places on a belt that winds up about an axis [n, 3]."""
    angle = along_m / np.hypot(TURN_M, PITCH_M / (2 * np.pi))
    x, y, foot = SPIRAL_M
    up = foot + PITCH_M * angle / (2 * np.pi)
    return np.stack([x + TURN_M * np.cos(angle), y + TURN_M * np.sin(angle), up], axis=1)


def _lane(along_m: Floats) -> Floats:
    """Return places on a way along x that bends and goes on along y [n, 3]."""
    x, y, high = LANE_M
    angle = np.clip((along_m - AHEAD_M) / BEND_M, 0.0, np.pi / 2)
    after = np.maximum(along_m - AHEAD_M - BEND_M * np.pi / 2, 0.0)
    out = x + np.minimum(along_m, AHEAD_M) + BEND_M * np.sin(angle)
    return np.stack([out, y + BEND_M * (1 - np.cos(angle)) + after, 0 * out + high], axis=1)


class Lot:
    """Rows of a table; `shift` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, shift: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.shift, self.rng, self.rare = table, shift, rng, rare
        self.far: Floats = self.of("true_range_m")
        self.bracket: Places = np.array([int(name[7:]) for name in table["rx"]], np.intp)
        self.tag: Places = np.array([TAGS.index(name) for name in table["tx"]], np.intp)
        names, self.place_of = np.unique(table["link"].to_numpy(str), return_inverse=True)
        self.links = len(names)

    def of(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64, copy=True)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1062, self.shift, what])

    def by_link(self, draw: Callable[..., Any], *how: float) -> Floats:
        """Return one drawn value for each link, at each of its rows [n]."""
        return np.asarray(draw(*how, self.links), np.float64)[self.place_of]

    def behind(self, share: float) -> Floats:
        """Return 1 at rows of such a share of the links, which are behind something, else 0 [n]."""
        return np.asarray(self.by_link(self.rng.uniform, 0.0, 1.0) < share, np.float64)

    def with_a(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([float(kind in some) for some in self.table["obstacles"]])

    def tags(self) -> Floats:
        """Return where tags are, as is written down [n, 3], in m."""
        return np.stack([self.of(f"tx_{axis}_m") for axis in "xyz"], axis=1)

    def brackets(self) -> Floats:
        """Return where brackets are, as is written down [n, 3], in m."""
        return BRACKETS_M[self.bracket]

    def speed(self) -> Floats:
        """Return at what speed belts and carts go on the whole, in m/s [n]."""
        return self.of("speed_mps")

    def gained(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.longer(self._on(later_s) - self._on(), 0.0)

    def _on(self, later_s: Floats | float = 0.0, ahead_m: float = 0.0) -> Floats:
        """Return where on its loop a tag is some time later, or so far ahead, in m [n, 3]."""
        course = {name: self.of(name) for name in COURSE}
        return place(course["loop"], moved_on(course, course["since_s"] + later_s) + ahead_m)

    def headings(self, ahead_m: float = 0.0) -> Floats:
        """Return which way belts go so far ahead, as lengths of 1 [n, 3]."""
        step = self._on(ahead_m=ahead_m + 0.01) - self._on(ahead_m=ahead_m - 0.01)
        return np.asarray(step / np.sqrt(np.sum(step**2, axis=1))[:, None])

    def bends(self) -> NDArray[np.bool_]:
        """Return whether belts turn where tags are [n]."""
        turned = np.sum((self.headings(0.02) - self.headings(-0.02)) ** 2, axis=1)
        return np.asarray(turned > 1e-8)

    def longer(self, tags_m: Floats | float, brackets_m: Floats | float) -> Floats:
        """Return by how much ways are longer with tags and brackets moved by [n, 3], in m [n]."""
        apart = self.tags() - self.brackets() + tags_m - brackets_m
        return np.asarray(np.sqrt(np.sum(apart**2, axis=1)) - self.far)
