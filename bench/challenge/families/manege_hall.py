"""The manege: letters, horses and harrows in a riding hall, what nobody knows of them, and rows.

numpy and pandas alone. Horses are ridden in circles, eights and serpentines, and nod with their
gait; harrows are drawn in lanes that weave a little. Radios hang at the letters of the arena.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HALL_M = (64.0, 23.0, 7.4)
LETTERS_M: Floats = np.array(
    [(1.2, 11.6, 4.8), (8.0, 0.7, 2.6), (20.5, 0.7, 5.9), (32.2, 0.7, 3.3), (44.0, 0.7, 6.3),
     (57.0, 0.7, 2.4), (62.9, 11.1, 5.2), (55.8, 22.3, 3.0), (43.5, 22.3, 4.4), (31.0, 22.3, 6.1),
     (19.2, 22.3, 2.7), (7.1, 22.3, 5.5)]
)  # fmt: skip
LETTERS, HORSES, HARROWS = len(LETTERS_M), 6, 3
TAGS = (*(f"horse{k}" for k in range(HORSES)), *(f"harrow{k}" for k in range(HARROWS)))
BETWEEN = {
    "wood": (0.21, 1.99, 1.7),
    "brick": (0.12, 3.91, 3.9),
    "glass": (0.036, 6.31, 1.6),
}
"""Jumps, a mounting block's wall, mirrors on wheels: m, permittivity, dB of each."""
FIGURE = (
    "mid_x", "mid_y", "mid_z", "goes_x", "goes_y", "wide_x", "wide_y", "pace", "twice", "turn_x",
    "turn_y", "nod_m", "gait_hz", "turn_z", "into_s",
)  # fmt: skip
"""Which figure a tag is ridden in, known to nobody."""
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.4944  # channel 1
DAY_S = 6.6 * 3600
POSTS_M = 5.37  # from one post of the kickboards to the next
PACE_M = 0.762  # of 30 inches
LAWS = {
    "sweat-under-the-cloth": Law(("saturation", "logarithm", "power")),
    "dust-raised": Law(("logarithm", "power", "saturation")),
    "footing-watered": Law(("power", "parabola")),
    "kickboard-posts-passed": Law(("periodic",), POSTS_M, "m", grows=False),
    "sprinklers-on": Law(("step",), 0.111, "m"),
    "girth-tightened": Law(("linear", "power")),
    "gate-of-tubes-near": Law(("inverse", "power", "inverse square")),
    "riders-crouch-at-speed": Law(),
    "letters-along-a-slack-cord": Law(),
    "antennas-by-turns": Law(),
    "letter-kicked-aside": Law(("position",), 0.45, "m", devices=("letter4",)),
    "letters-of-two-posts-mistaken": Law(("swap",), devices=("letter1", "letter8")),
    "paces-from-one-letter": Law(("unit",), 1 / PACE_M, "1", grows=False, devices=("letter9",)),
}  # fmt: skip
"""What nobody's library has."""


class Strain(NamedTuple):
    """What strains rows [n]: metres; dB of all that comes, of first paths, of noise, of counts."""

    metres: Floats | float = 0.0
    whole_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def ridden(figure: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m: a swing along the hall, one across it, and a nod."""
    turn = figure["pace"] * into_s
    nod = 2 * np.pi * figure["gait_hz"] * into_s + figure["turn_z"]
    return np.column_stack(
        [
            figure["mid_x"]
            + figure["goes_x"] * into_s
            + figure["wide_x"] * np.sin(turn + figure["turn_x"]),
            figure["mid_y"]
            + figure["goes_y"] * into_s
            + figure["wide_y"] * np.sin(figure["twice"] * turn + figure["turn_y"]),
            figure["mid_z"] + figure["nod_m"] * np.sin(nod),
        ]
    )


def velocity(figure: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return how fast tags are [n, 3], in m/s: central differences over 2 ms."""
    return np.asarray((ridden(figure, into_s + 1e-3) - ridden(figure, into_s - 1e-3)) / 2e-3)


class Lesson:
    """Rows of a table; `stable` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, scarce: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.scarce = table, stable, rng, scarce
        self.count = len(table)

    def column(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name].to_numpy(), np.float64)

    @cached_property
    def reach(self) -> Floats:
        """True distances in m [n]."""
        return self.column("true_range_m")

    @cached_property
    def letter(self) -> Integers:
        """Numbers of letters [n]."""
        return np.asarray(self.table["tx"].str.removeprefix("letter").astype(np.int64), np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n]: horses first."""
        return np.asarray(self.table["rx"].map({n: k for k, n in enumerate(TAGS)}), np.int64)

    @cached_property
    def ridden(self) -> Floats:
        """1 at rows of horses, 0 at those of harrows [n]."""
        return np.asarray(self.tag < HORSES, np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n]."""
        return np.asarray(pd.factorize(self.table["link"])[0], np.int64)

    @cached_property
    def at(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return np.stack([self.column(f"rx_{axis}_m") for axis in "xyz"], axis=1)

    @cached_property
    def post(self) -> Floats:
        """Where letters are said to be [n, 3], in m."""
        return np.asarray(LETTERS_M[self.letter])

    @cached_property
    def figure(self) -> dict[str, Floats]:
        """Which figures tags are ridden in, [n] each."""
        return {name: self.column(name) for name in FIGURE}

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, 1401, self.stable])

    def per_link(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.link.max()) + 1), np.float64)[self.link]

    def some(self, share: float) -> Floats:
        """Return 1 at rows of such a share of links, else 0 [n]."""
        return self.per_link(lambda n: self.rng.permutation(n) < round(share * n))

    def crosses(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path crosses such a thing, else 0 [n]."""
        return np.array([kind in things for things in self.table["obstacles"]], np.float64)

    def lengthens(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        figure = self.figure
        now, then = (ridden(figure, figure["into_s"] + one) for one in (0.0, later_s))
        return self.off(then - now)

    def off(self, tag_m: Floats | float, post_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by [n, 3], in m [n]."""
        way = self.at - self.post
        far = np.sqrt(((way + tag_m - post_m) ** 2).sum(axis=1))
        return np.asarray(far - np.sqrt((way**2).sum(axis=1)))
