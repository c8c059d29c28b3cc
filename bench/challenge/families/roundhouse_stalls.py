"""The roundhouse: engines, a turntable and hoists, what nobody knows of these, and rows of effects.

numpy and pandas alone. All is round a turntable's middle: engines roll out of stalls along rays, or
into them, ever slower as air brakes them; the turntable's ends go round, and so do hoists, on a
ring of rail below the roof. Readers hang at piers between stalls, at the round wall and at masts.
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
CENTRE_M = (38.0, 11.0)  # the turntable's middle
DOORS_M, WALL_M, ROOF_M = 15.8, 35.0, 7.8  # from the middle; above the floor
TABLE_M, RING_M = 8.4, 25.4  # from the middle, where tags ride
STALLS, WIDE_RAD = 12, np.pi / 12
PIERS_AT: Floats = np.array(
    [(16.4, 9, 4.1), (16.4, 43, 3.3), (16.4, 78, 4.6), (16.4, 114, 3.6), (16.4, 150, 4.4),
     (33.6, 22, 5.2), (33.6, 61, 3.4), (33.6, 97, 5.9), (33.6, 131, 4.3), (33.6, 168, 5.5),
     (12.5, 262, 6.6), (11.8, 322, 5.0)]
)  # fmt: skip
"""From the middle in m, round it in degrees, above the floor in m."""
PIERS, ENGINES, ENDS, HOISTS = len(PIERS_AT), 4, 2, 3
TAGS = (
    *(f"engine{k}" for k in range(ENGINES)),
    *(f"end{k}" for k in range(ENDS)),
    *(f"hoist{k}" for k in range(HOISTS)),
)
ROADS_RAD: Floats = WIDE_RAD * (np.array([1.0, 4.0, 7.0, 10.0]) + 0.5)  # that engines roll on
BETWEEN = {
    "brick": (0.27, 0.72, 3.91, 3.2),
    "wood": (0.2, 0.8, 1.99, 1.4),
    "glass": (0.032, 0.9, 6.31, 1.6),
}
"""Piers' flanks, doors and panes of these: m, share of solid, permittivity of that, dB."""
COURSE = (
    "from_r", "go_r", "from_rad", "go_rad", "from_z", "go_z", "way_of_going", "lasts_s", "into_s"
)  # fmt: skip
"""How a tag goes, known to nobody; `way_of_going`: of engines, of the turntable, of hoists."""
DRAGGED = 2.6  # by how much engines are slower at the end of a course: one over 1 and this
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 6.4896  # channel 5
DAY_S = 9.6 * 3600
CHAIR_M = 0.838  # from one chair of the rails to the next
ARSHIN_M = 0.7112  # of Russia
LAWS = {
    "steam-leaks": Law(("saturation", "logarithm", "power")),
    "bunker-filled": Law(("linear", "power")),
    "pit-takes-water": Law(("power", "parabola")),
    "rail-chairs-passed": Law(("periodic",), CHAIR_M, "m", grows=False),
    "louvres-opened": Law(("step",), 0.106, "m"),
    "welder-near": Law(("inverse", "power", "inverse square")),
    "oil-creeps-on-covers": Law(("logarithm", "power", "saturation")),
    "table-gear-has-play": Law(),
    "roads-splayed-wider": Law(),
    "second-layer-on-the-drum": Law(),
    "stamps-fall-behind": Law(),
    "pier-struck-by-a-tender": Law(("position",), 0.46, "m", devices=("pier6",)),
    "piers-named-crosswise": Law(("swap",), devices=("pier2", "pier9")),
    "arshins-from-one-pier": Law(("unit",), 1 / ARSHIN_M, "1", grows=False, devices=("pier3",)),
}
"""What nobody's library has."""


def placed(out_m: Floats, round_rad: Floats, high_m: Floats) -> Floats:
    """Return places [n, 3], in m, by how far from the middle, where round it, and how high."""
    x, y = (out_m * turn(round_rad) for turn in (np.cos, np.sin))
    return np.stack([CENTRE_M[0] + x, CENTRE_M[1] + y, high_m], axis=1)


PIERS_M = placed(PIERS_AT[:, 0], np.pi / 180 * PIERS_AT[:, 1], PIERS_AT[:, 2])
FRONTS_M = placed(np.full(STALLS, 18.6), WIDE_RAD * np.arange(0.5, STALLS), np.full(STALLS, 2.3))
"""Smokeboxes of engines that stand in stalls, one in each."""


@dataclass(frozen=True)
class Toll:
    """What becomes of rows [n]: metres; dB of all that comes, of first paths, of noise, of sums."""

    metres: Floats | float = 0.0
    whole_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    hiss_db: Floats | float = 0.0
    sums_db: Floats | float = 0.0


def gone(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return which part of a course is gone [n].

    Of engines by a logarithm, as air brakes by the square of speed; of the turntable by a
    polynomial of the fifth degree, without jerks; of hoists by one of the third.
    """
    part = into_s / course["lasts_s"]
    rolls = np.log1p(DRAGGED * part.clip(-0.25, 1.4)) / np.log1p(DRAGGED)
    part = part.clip(0.0, 1.0)
    turns, hangs = part**3 * (10 - 15 * part + 6 * part**2), part**2 * (3 - 2 * part)
    way = course["way_of_going"]
    return np.asarray(np.select([way < 0.5, way < 1.5], [rolls, turns], hangs))


def carried(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m: along rays, round the middle, up and down."""
    part = gone(course, into_s)
    return placed(*(course[f"from_{k}"] + part * course[f"go_{k}"] for k in ("r", "rad", "z")))


class Shunt:
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
    def pier(self) -> Integers:
        """Numbers of piers [n]."""
        return self.table["rx"].str[len("pier") :].to_numpy(np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n]: engines, ends of the turntable, hoists."""
        return np.array([TAGS.index(name) for name in self.table["tx"]], np.int64)

    def rides(self, kind: str) -> Floats:
        """Return 1 at rows of tags of a kind, else 0 [n]."""
        return np.array([name.startswith(kind) for name in self.table["tx"]], np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n], from 0 on."""
        return pd.factorize(self.table["link"], sort=True)[0].astype(np.int64)

    @cached_property
    def shunt(self) -> Integers:
        """Numbers of shunts [n], from 0 on."""
        told = self.table["link"].str.extract(r"shunt (\d+)", expand=False).astype(int)
        return pd.factorize(told, sort=True)[0].astype(np.int64)

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return self.table[[f"tx_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)

    @cached_property
    def hung(self) -> Floats:
        """Where readers are said to hang [n, 3], in m."""
        return PIERS_M[self.pier]

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1701, what])

    def per_link(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return lots of links, one for each, at their rows [n]."""
        return np.asarray(lots(self.link.max() + 1), np.float64)[self.link]

    def per_shunt(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return lots of shunts, one for each, at their rows [n]."""
        return np.asarray(lots(self.shunt.max() + 1), np.float64)[self.shunt]

    def unseen(self, share: float) -> Floats:
        """Return 1 at such a share of all links, of those without line of sight, else 0 [n]."""
        hidden = ~self.table.groupby(self.link)["los"].first().to_numpy(bool)
        lots = np.where(hidden, self.rng.random(len(hidden)), 2.0)
        wanted = np.clip(round(share * len(hidden)), 1, hidden.sum())
        return np.asarray(lots <= np.sort(lots)[wanted - 1], np.float64)[self.link]

    def through(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return np.array([kind in things for things in self.table["obstacles"]], np.float64)

    @cached_property
    def crossed(self) -> Floats:
        """How many stalls' widths straight paths cross round the middle [n], parts of them too."""
        both = ((p[:, :2] - CENTRE_M) @ np.array([1.0, 1.0j]) for p in (self.there, self.hung))
        return np.asarray(np.abs(np.angle(next(both) * next(both).conj())) / WIDE_RAD)

    def along(self, outward: bool) -> Floats:
        """Return which part of straight paths is outward from the middle, else round it [n].

        As it is halfway.
        """
        ray = (0.5 * (self.there + self.hung))[:, :2] - CENTRE_M
        ray = ray / np.linalg.norm(ray, axis=1, keepdims=True)
        ray = ray if outward else ray[:, ::-1] * [-1.0, 1.0]
        return np.asarray(np.abs(((self.there - self.hung)[:, :2] * ray).sum(axis=1)) / self.far)

    def lengthens(self, tag_m: Floats | float, pier_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by [n, 3], in m [n]."""
        said = self.there - self.hung
        true, far = (np.sqrt((way**2).sum(axis=1)) for way in (said + tag_m - pier_m, said))
        return np.asarray(true - far)

    def goes_on(self, later_s: Floats | float) -> Floats:
        """Return how tags have moved some time later, in m [n, 3]."""
        now_s = self.course["into_s"]
        return carried(self.course, now_s + later_s) - carried(self.course, now_s)

    def lengthens_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.lengthens(self.goes_on(later_s))
