"""The breadworks: trays, racks, porters and moulds about its ovens, and rows of these.

numpy and pandas alone. Corbels of walls and pillars have radios, and so have three that hang from a
flue. Trays climb a helix round spiral coolers; racks that are shoved roll on while castors drag as
honey does; porters with sacks meander by a curve whose heading is a sine of the way; moulds ride on
tables that index from stand to stand by cycloidal cams.
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
HALL_M = (54.0, 31.0, 9.0)
METRES_OF_PPM_MS = 0.149896229  # of a reply that lasts a millisecond, by a clock a millionth off
WAVE_M = 0.299792458 / 6.4896  # channel 5
NIGHT_S = 9.5 * 3600
LINK_M = 0.87  # from one support of the spiral's belt to the next
LOW_KG = 240.0  # of flour in the hopper, below which the sifter runs
BRAZA_M = 1.6718
CORBELS_M: Floats = np.array(
    [(1.5, 5.5, 3.4), (1.8, 25.0, 5.2), (12.5, 1.4, 4.4), (26.5, 1.7, 3.0), (41.0, 1.5, 5.6),
     (52.4, 8.0, 3.8), (52.2, 24.5, 4.9), (40.5, 29.4, 3.2), (24.0, 29.6, 5.8), (11.0, 29.3, 3.9),
     (14.0, 16.2, 7.4), (27.5, 16.2, 7.1), (43.0, 16.2, 7.6)]
)  # fmt: skip
"""Where corbels have their radios, in m [CORBELS, 3]; the last three hang from the flue."""
CORBELS, OF_FLUE = len(CORBELS_M), (10, 11, 12)
COOLERS_M, TABLES_M = ((12.0, 9.0), (41.0, 22.0)), ((27.0, 8.5), (24.5, 23.0))
PITCH_M, STANDS = 0.17, 8  # by which trays rise in a turn; stands of a table
KINDS = {"tray": 3, "rack": 4, "porter": 3, "mould": 2}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"tray": "coolers", "rack": "ovens", "porter": "flour store", "mould": "make-up"}
COURSE = ("kind", "from_x", "from_y", "level", "toward", "speed", "swing", "fades", "reach",
          "goes", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `brought_to`."""
LAWS = {
    "steam-let-into-ovens": Law(("saturation", "logarithm", "power")),
    "dough-swells-over-troughs": Law(("power", "parabola")),
    "hook-hung-close-by": Law(("inverse square", "power", "inverse")),
    "flour-settles-since-swept": Law(("logarithm", "power", "saturation")),
    "tins-stacked-alongside": Law(("linear", "power")),
    "supports-of-the-belt-pass": Law(("periodic",), LINK_M, "m", grows=False),
    "sifter-runs-on-a-low-hopper": Law(("step",), 0.094, "m"),
    "yeast-works-by-warmth-and-hours": Law(),
    "belts-slip-round-coolers": Law(),
    "castors-clogged-with-dough": Law(),
    "porters-sway-wider-than-told": Law(),
    "cams-worn-between-stands": Law(),
    "flue-buckles-as-ovens-heat": Law(),
    "plan-fed-askew": Law(),
    "missed-answers-put-on-a-line": Law(),
    "corbel-rammed-by-a-rack": Law(("position",), 0.52, "m", devices=("corbel3",)),
    "corbels-entered-in-each-others-lines": Law(("swap",), devices=("corbel2", "corbel7")),
    "brazas-from-one-corbel": Law(
        ("unit",), 1 / BRAZA_M, "1", grows=False, devices=("corbel8",)
    ),
}  # fmt: skip
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Does:
    """What is done to rows [n]: `late_m` to ranges; dB to all, first paths, noise, and counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def off_walls(at: Floats) -> Floats:
    """Return how far places [..., 3] are from the nearest wall in m [...]; < 0 behind it."""
    flat, most = at[..., :2], np.array(HALL_M[:2])
    return np.asarray(np.minimum(flat, most - flat).min(axis=-1))


def climbed(course: Course, gone_s: Floats, slip: float = 0.0) -> Floats:
    """Return where trays are on a helix, in m [n, 3]; belts slip by a part of what drums turn."""
    turn = course["speed"] * (1 - slip) * gone_s / course["reach"].clip(0.1)
    angle = course["toward"] + turn
    x = course["from_x"] + course["reach"] * np.cos(angle)
    y = course["from_y"] + course["reach"] * np.sin(angle)
    return np.stack([x, y, course["level"] + PITCH_M * np.abs(turn) / (2 * np.pi)], axis=1)


def rolled(course: Course, gone_s: Floats, clogged: float = 0.0) -> Floats:
    """Return where racks are, in m [n, 3]: castors that are clogged drag by a part more.

    What drags grows with the speed, so that this falls by an exponential.
    """
    fades = course["fades"].clip(0.1) / (1 + clogged)
    way = -course["speed"] * fades * np.expm1(-gone_s / fades)
    x = course["from_x"] + way * np.cos(course["toward"])
    y = course["from_y"] + way * np.sin(course["toward"])
    return np.stack([x, y, course["level"]], axis=1)


def meandered(course: Course, gone_s: Floats, wider: float = 0.0) -> Floats:
    """Return where porters are, in m [n, 3]: rivers' curve (Langbein and Leopold 1966).

    Its heading swings by a sine of the way; by 20 of Gauss's places. `wider`: the part by which it
    swings more.
    """
    at, by = np.polynomial.legendre.leggauss(20)
    way = 0.5 * (course["speed"] * gone_s)[:, None] * (at + 1)
    turn = 2 * np.pi * way / course["reach"].clip(0.1)[:, None] + course["fades"][:, None]
    heading = course["toward"][:, None] + (1 + wider) * course["swing"][:, None] * np.sin(turn)
    long = 0.5 * (course["speed"] * gone_s)[:, None] * by
    x = course["from_x"] + (long * np.cos(heading)).sum(axis=1)
    y = course["from_y"] + (long * np.sin(heading)).sum(axis=1)
    return np.stack([x, y, course["level"]], axis=1)


def indexed(course: Course, gone_s: Floats, worn: float = 0.0) -> Floats:
    """Return where moulds are on tables, in m [n, 3]: a cycloid's cam takes these on and dwells.

    `worn`: radians by which cams are ahead or behind amid a step.
    """
    step = gone_s / course["fades"].clip(0.1)
    late = np.sin(2 * np.pi * step)
    turn = course["speed"] * (step - late / (2 * np.pi)) * 2 * np.pi / STANDS
    angle = course["toward"] + turn + worn * late
    x = course["from_x"] + course["reach"] * np.cos(angle)
    y = course["from_y"] + course["reach"] * np.sin(angle)
    return np.stack([x, y, course["level"]], axis=1)


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (climbed, rolled, meandered, indexed)
"""Of kinds as in KINDS."""


def brought_to(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * into_s
    there = np.zeros((len(gone_s), 3))
    for number, way in enumerate(WAYS):
        own = np.flatnonzero(course["kind"] == number)
        there[own] = way({name: one[own] for name, one in course.items()}, gone_s[own])
    return there


class Bake:
    """Rows of a table; `case` seeds what tables of a case share, `rng` draws all else.

    `corbel`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.corbel: Integers = table["rx"].str.extract(r"(\d+)$")[0].to_numpy().astype(np.int64)
        self.tag: Integers = np.array([TAGS.index(one) for one in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.case, 3703, what])

    def by_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
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
    def corbel_m(self) -> Floats:
        """Where corbels' radios are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def are(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.bool_)

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([1.0 if what in some else 0.0 for some in self.table["obstacles"]])

    def cut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, drawn from those behind something, else 0 [n]."""
        behind = np.unique(self.link[self.table["obstacles"].map(len).to_numpy() > 0])
        wanted = max(1, round(share * (int(self.link.max()) + 1)))
        some = self.rng.choice(behind, min(wanted, len(behind)), replace=False)
        return np.isin(self.link, some).astype(np.float64)

    def longer(self, tag_m: Floats | float, corbel_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much [n, 3], in m [n]."""
        off = self.corbel_m + corbel_m - self.tag_m - tag_m
        return np.asarray(np.linalg.norm(off, axis=1) - self.apart)

    @cached_property
    def apart(self) -> Floats:
        """How far ends are said to be apart, in m [n]."""
        return np.asarray(np.linalg.norm(self.corbel_m - self.tag_m, axis=1))

    def rolls_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        into_s = self.course["into_s"]
        there = brought_to(self.course, into_s + later_s) - brought_to(self.course, into_s)
        return self.longer(there)
