"""The hangar: girders, tugs and lifts among aircraft, what nobody knows of them, and rows.

numpy and pandas alone. Tugs drive in bends; baskets of boom lifts are slewed and raised. Both go
round a pivot at the end of a boom, which for tugs is the radius of their bend.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
HALL_M = (52.0, 38.0, 15.0)
GIRDERS_M: Floats = np.array(
    [(0.5, 4.2, 6.1), (0.5, 19.3, 11.4), (0.5, 33.8, 3.6), (17.4, 0.6, 9.2), (35.1, 0.6, 4.4),
     (51.5, 5.6, 10.3), (51.5, 20.4, 3.9), (51.5, 33.1, 7.7), (33.0, 37.4, 12.1), (15.2, 37.4, 5.3)]
)  # fmt: skip
GIRDERS, TUGS, LIFTS = len(GIRDERS_M), 4, 4
SHINY_M: Floats = np.array(
    [(11.5, 12.8, 2.4), (13.1, 25.7, 2.5), (30.5, 11.9, 2.4), (31.4, 27.0, 2.5), (22.8, 19.0, 11.5),
     (41.7, 18.7, 12.3)]
)  # fmt: skip
"""Engines and fins of two aircraft."""
BETWEEN = {
    "plywood": (0.14, 2.71, 1.9),
    "plastic": (0.19, 2.55, 1.3),
    "concrete": (0.17, 5.24, 4.5),
}
"""Docks of planks, fairings on racks, pillars: m, permittivity, dB of each."""
WAY = ("pivot_x", "pivot_y", "pivot_z", "boom_m", "begun", "slew", "tilt", "tilts", "ease", "beat",
       "turn", "sense", "since_s")  # fmt: skip
"""How a tag goes round its pivot, known to nobody."""
FOR_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 2
DAY_S = 7.4 * 3600
TIES_M = 4.57  # from one ring for lashing to the next
ARSHIN_M = 0.7112
LAWS = {
    "skydrol-on-domes": Law(("logarithm", "power", "saturation")),
    "deicer-in-covers": Law(("saturation", "logarithm", "power")),
    "tanks-vented": Law(("power", "parabola")),
    "lashing-rings-passed": Law(("periodic",), TIES_M, "m", grows=False),
    "radiant-heaters-lit": Law(("step",), 0.117, "m"),
    "humidity-swells-honeycomb": Law(("linear", "power")),
    "ground-power-sags": Law(("inverse", "power", "inverse square")),
    "booms-droop": Law(),
    "tags-on-the-towbar": Law(),
    "words-torn-in-reading": Law(),
    "girder-bent-by-a-fin": Law(("position",), 0.46, "m", devices=("girder3",)),
    "girders-cabled-crosswise": Law(("swap",), devices=("girder2", "girder7")),
    "arshins-from-one-girder": Law(("unit",), 1 / ARSHIN_M, "1", grows=False, devices=("girder8",)),
}  # fmt: skip
"""What nobody's library has."""


class Toll(NamedTuple):
    """What rows [n] get: metres; dB of all, of first paths, of noise, and of sums."""

    metres: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    sums_db: Floats | float = 0.0


def swung(way: dict[str, Floats], at_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m: so far round their pivots, sooner and later by turns."""
    gone = at_s + way["ease"] / way["beat"] * (
        np.sin(way["beat"] * at_s + way["turn"]) - np.sin(way["turn"])
    )
    bearing, tilt = way["begun"] + way["slew"] * gone, way["tilt"] + way["tilts"] * gone
    flat = way["boom_m"] * np.cos(tilt)
    return np.stack(
        [
            way["pivot_x"] + flat * np.cos(bearing),
            way["pivot_y"] + flat * np.sin(bearing),
            way["pivot_z"] + way["boom_m"] * np.sin(tilt),
        ],
        axis=1,
    )


@dataclass(frozen=True)
class Job:
    """Rows of a table; `day` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    day: int
    rng: np.random.Generator
    few: bool = False

    def of(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name].to_numpy(), np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @cached_property
    def girder(self) -> Whole:
        """Numbers of girders [n]."""
        return self.table["rx"].str.removeprefix("girder").to_numpy(np.int64)

    @cached_property
    def lifted(self) -> NDArray[np.bool_]:
        """True at rows of lifts [n]."""
        return np.asarray(self.table["tx"].str.startswith("lift"), bool)

    @cached_property
    def rider(self) -> Whole:
        """Numbers of tags [n]: tugs first, then lifts."""
        number = self.table["tx"].str.extract(r"(\d+)$")[0].to_numpy(np.int64)
        return np.asarray(number + TUGS * self.lifted, np.int64)

    @cached_property
    def link(self) -> Whole:
        """Numbers of links [n]."""
        return np.asarray(pd.factorize(self.table["link"])[0], np.int64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1311, what, self.day])

    def by_links(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.link.max()) + 1), np.float64)[self.link]

    def behind(self, share: float) -> Floats:
        """Return 1 at rows of such a share of links, else 0 [n]."""
        return self.by_links(lambda n: self.rng.random(n) < share)

    def through(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return np.asarray(self.table["obstacles"].map(lambda some: kind in some), np.float64)

    @cached_property
    def tag(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def ear(self) -> Floats:
        """Where girders' radios are said to be [n, 3], in m."""
        return np.asarray(GIRDERS_M[self.girder])

    def way(self) -> dict[str, Floats]:
        """Return how tags go round their pivots, [n] each."""
        return {name: self.of(name) for name in WAY}

    def onward(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        way = self.way()
        now, then = (swung(way, way["since_s"] + one) for one in (0.0, later_s))
        return self.longer(then - now)

    def longer(self, tag_m: Floats | float, ear_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer with ends off by [n, 3], in m [n]."""
        return np.asarray(np.linalg.norm(self.tag + tag_m - self.ear - ear_m, axis=1) - self.far)

    def ahead(self) -> Floats:
        """Return unit vectors of which way tugs look [n, 3]: along their bends."""
        out = self.tag - self.table[["pivot_x", "pivot_y", "pivot_z"]].to_numpy(np.float64)
        out = self.of("sense")[:, None] * out / self.of("boom_m")[:, None]
        return np.column_stack([-out[:, 1], out[:, 0], np.zeros(len(out))])
