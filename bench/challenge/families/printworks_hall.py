"""The printworks: trucks, grippers and reels of a press hall, what nobody knows of them, and rows.

numpy and pandas alone. Driverless trucks steer along arcs between stops; grippers hang on a chain
that runs round over the press, higher over one end of it; reels of paper are pushed and roll out,
so that tags beside their rims trace trochoids. Readers hang at stanchions, on towers of the press,
along walls and below the roof.
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
HALL_M = (52.0, 28.0, 9.6)  # along the press, across it, up
PRESS_M = (11.0, 41.0, 12.3, 15.9)  # from and to, along the hall and across it
TOWERS_M: Floats = np.array([13.0, 19.5, 26.0, 32.5, 39.0])  # of the press, along the hall
TALL_M = 6.2  # towers
STANCHIONS_M: Floats = np.array(
    [(13.0, 11.8, 5.7), (26.0, 16.4, 6.1), (39.0, 11.9, 5.4), (32.5, 16.5, 6.0),
     (4.0, 0.6, 2.3), (18.5, 0.7, 1.9), (34.0, 0.5, 2.8), (49.0, 0.8, 2.1),
     (7.5, 27.3, 2.6), (23.0, 27.4, 1.8), (44.5, 27.2, 3.1),
     (12.0, 7.5, 8.9), (40.0, 21.0, 9.0)]
)  # fmt: skip
"""Where readers hang, in m."""
STANCHIONS, ON_TOWERS = len(STANCHIONS_M), 4
TRUCKS, GRIPPERS, REELS = 4, 4, 2
TAGS = (
    *(f"truck{k}" for k in range(TRUCKS)),
    *(f"gripper{k}" for k in range(GRIPPERS)),
    *(f"reel{k}" for k in range(REELS)),
)
KINDS = ("aisles", "chain", "reel store")
"""Where trucks, grippers and reels go."""
BETWEEN = {
    "paper": (0.0, 0.0, 5.5),
    "plasterboard": (0.075, 2.73, 1.7),
    "glass": (0.022, 6.31, 2.1),
    "wood": (0.09, 1.99, 1.2),
}
"""What ways go through: thick in m, permittivity, dB. Paper is met at chords of reels."""
COURSE = ("kind", "from_x", "from_y", "from_z", "aim", "bend", "long_m", "lasts_s", "into_s")
"""How a tag goes, known to nobody: `kind` as in KINDS; `aim`, `bend`: see `carried`."""
EASED = 1.9  # how quickly trucks are at their speed: half a hyperbolic tangent's argument
STRAIGHT_M, TURN_M = 22.0, 4.6  # of the chain's loop: sides, and radius of both ends
LOOP_M = 2 * STRAIGHT_M + 2 * np.pi * TURN_M
LOOP_AT = (15.0, 14.1, 6.9, 0.95)  # where it begins, its middle, how high, by how much it climbs
RIM_M, BESIDE_M = 0.56, 0.41  # of reels: their radius, and how far tags are from their middle
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 2
NIGHT_S = 7.6 * 3600  # while papers are printed
CUT_M = 0.546  # of web from one cut of the folder to the next
ELLE_M = 0.6669  # of Prussia
LAWS = {
    "ink-mist-on-covers": Law(("saturation", "logarithm", "power")),
    "webs-slack": Law(("inverse", "power", "inverse square")),
    "reels-unwound": Law(("parabola", "power")),
    "spray-bars-on": Law(("linear", "power")),
    "folder-cuts": Law(("periodic",), CUT_M, "m", grows=False),
    "hood-lifted": Law(("step",), 0.098, "m"),
    "covers-of-card-swell": Law(("power", "saturation", "logarithm")),
    "wheels-of-unlike-size": Law(),
    "chain-worn-long": Law(),
    "towers-shake": Law(),
    "surveyed-one-from-the-next": Law(),
    "tags-tire": Law(),
    "stanchion-hit-by-a-reel": Law(("position",), 0.49, "m", devices=("stanchion9",)),
    "stanchions-plugged-crosswise": Law(("swap",), devices=("stanchion5", "stanchion10")),
    "ellen-from-one-stanchion": Law(
        ("unit",), 1 / ELLE_M, "1", grows=False, devices=("stanchion6",)
    ),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Change:
    """What becomes of rows [n]: metres; dB of all, of first paths, of noise, of what is counted."""

    metres: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def looped(along_m: Floats) -> Floats:
    """Return places on the chain's loop [n, 3], in m, by how far they are along it [n]."""
    half = 0.5 * LOOP_M
    second, rest = np.divmod(np.mod(along_m, LOOP_M), half)
    turn = (rest - STRAIGHT_M).clip(0.0) / TURN_M
    x = np.minimum(rest, STRAIGHT_M) + TURN_M * np.sin(turn) - 0.5 * STRAIGHT_M
    both = np.stack([x, -TURN_M * np.cos(turn)]) * (1 - 2 * second)
    high = LOOP_AT[2] + LOOP_AT[3] * both[0] / (0.5 * STRAIGHT_M + TURN_M)
    return np.stack([LOOP_AT[0] + 0.5 * STRAIGHT_M + both[0], LOOP_AT[1] + both[1], high], axis=1)


def gone_m(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return how far courses have gone by then, in m [n].

    Trucks by a hyperbolic tangent, from rest to rest; grippers evenly; reels slow down evenly.
    """
    part = into_s / course["lasts_s"]
    eased = 0.5 + 0.5 * np.tanh(EASED * (2 * part.clip(0.0, 1.0) - 1)) / np.tanh(EASED)
    rolls = 1 - (1 - part).clip(0.0) ** 2
    return np.asarray(
        course["long_m"]
        * np.select([course["kind"] < 0.5, course["kind"] < 1.5], [eased, part], rolls)
    )


def carried(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m.

    Trucks begin into the direction of `aim` and turn by `bend` a metre; grippers begin `aim` along
    their loop; reels roll into the direction of `aim`, their tags at first `bend` from the top.
    """
    gone, aim, bend = gone_m(course, into_s), course["aim"], course["bend"]
    begun = np.stack([course[f"from_{axis}"] for axis in "xyz"], axis=1)
    half = 0.5 * bend * gone
    chord = gone * np.sinc(half / np.pi)
    trucks = [chord * np.cos(aim + half), chord * np.sin(aim + half), 0.0 * gone]
    turned = bend + gone / RIM_M
    ahead = gone + BESIDE_M * np.sin(turned)
    reels = [ahead * np.cos(aim), ahead * np.sin(aim), BESIDE_M * np.cos(turned)]
    moved = np.where(course["kind"] < 0.5, np.stack(trucks), np.stack(reels)).T
    on_chain = (course["kind"] > 0.5) & (course["kind"] < 1.5)
    return np.where(on_chain[:, None], looped(aim + gone), begun + moved)


class Sheet:
    """Rows of a table; `stable` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.rare = table, stable, rng, rare
        self.size = len(table)

    def __getitem__(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def reader(self) -> Integers:
        """Numbers of stanchions [n]."""
        return self.table["rx"].str.removeprefix("stanchion").to_numpy(np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n]: trucks, grippers, reels."""
        return np.array([*map(TAGS.index, self.table["tx"])], np.int64)

    def carries(self, kind: str) -> Floats:
        """Return 1 at rows of trucks, grippers or reels, else 0 [n]."""
        return np.array([name.startswith(kind) for name in self.table["tx"]], np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n], from 0 on."""
        return np.unique(self.table["link"].to_numpy(str), return_inverse=True)[1].astype(np.int64)

    @cached_property
    def run(self) -> Integers:
        """Numbers of runs [n], from 0 on."""
        told = self.table["link"].str.split(" by ").str[0].to_numpy(str)
        return np.unique(told, return_inverse=True)[1].astype(np.int64)

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return np.stack([self[f"tx_{axis}_m"] for axis in "xyz"], axis=1)

    @cached_property
    def hung(self) -> Floats:
        """Where readers are said to hang [n, 3], in m."""
        return STANCHIONS_M[self.reader]

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    @cached_property
    def since_s(self) -> Floats:
        """How long after their runs' first rows rows are, in s [n]."""
        first = np.full(self.run.max() + 1, np.inf)
        np.minimum.at(first, self.run, self.course["into_s"])
        return np.asarray(self.course["into_s"] - first[self.run])

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1801, what])

    def by_link(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return lots of links, one for each, at their rows [n]."""
        return np.asarray(lots(int(self.link.max()) + 1), np.float64)[self.link]

    def behind(self, share: float) -> Floats:
        """Return 1 at such a share of all links, of those that something stands between, else 0."""
        met = np.zeros(self.link.max() + 1, bool)
        np.logical_or.at(met, self.link, self.table["obstacles"].str.len().to_numpy() > 0)
        order = self.rng.permutation(np.flatnonzero(met))
        chosen = np.zeros(len(met))
        chosen[order[: max(1, round(share * len(met)))]] = 1.0
        return chosen[self.link]

    def through(self, what: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return np.array([what in things for things in self.table["obstacles"]], np.float64)

    @cached_property
    def amid_m(self) -> Floats:
        """How many metres of straight paths are over or in the press, seen from above [n]."""
        enters, leaves = np.zeros(self.size), np.ones(self.size)
        for axis, low, high in ((0, *PRESS_M[:2]), (1, *PRESS_M[2:])):
            step = self.hung[:, axis] - self.there[:, axis]
            step = np.where(np.abs(step) < 1e-6, 1e-6, step)
            ends = np.sort([(edge - self.there[:, axis]) / step for edge in (low, high)], axis=0)
            enters, leaves = np.maximum(enters, ends[0]), np.minimum(leaves, ends[1])
        return np.asarray((leaves - enters).clip(0.0) * self.far)

    def lengthens(self, tag_m: Floats | float, reader_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by [n, 3], in m [n]."""
        said = self.there - self.hung
        return np.asarray(
            np.linalg.norm(said + tag_m - reader_m, axis=1) - np.linalg.norm(said, axis=1)
        )

    def moves(self, later_s: Floats | float) -> Floats:
        """Return how tags have moved some time later, in m [n, 3]."""
        now_s = self.course["into_s"]
        return carried(self.course, now_s + later_s) - carried(self.course, now_s)

    def lengthens_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.lengthens(self.moves(later_s))
