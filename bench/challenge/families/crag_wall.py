"""The crag: walls of a climbing hall, how they are climbed, what nobody knows of it, and rows.

numpy and pandas alone. Harnesses go up routes by long moves with rests between them, or are let
down; bolts on walls and below the roof range them. Routes lean out of their walls and aside.
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
HALL_M = (27.0, 16.4, 17.0)
BOLTS_M: Floats = np.array(
    [(0.3, 1.0, 9.5), (0.3, 10.6, 14.6), (0.4, 15.6, 3.1), (26.7, 1.2, 13.4), (26.6, 11.2, 7.2),
     (26.5, 15.8, 15.1), (10.4, 0.3, 11.7), (21.9, 0.3, 2.6), (13.4, 7.1, 15.9), (13.6, 11.3, 4.4),
     (6.3, 16.1, 2.2), (20.2, 16.1, 10.3)]
)  # fmt: skip
BOLTS, HARNESSES = len(BOLTS_M), 9
ROUTES: Floats = np.array(
    [(0.4, 3.0, 1, 0, 0.18, 0.10), (0.4, 8.1, 1, 0, 0.05, -0.12), (0.4, 13.2, 1, 0, 0.30, 0.06),
     (26.6, 4.2, -1, 0, 0.10, 0.15), (26.6, 9.0, -1, 0, 0.25, -0.08), (26.6, 13.6, -1, 0, 0.02, .1),
     (7.1, 0.4, 0, 1, 0.12, 0.1), (18.0, 0.4, 0, 1, 0.22, -0.15), (12.1, 9.0, -1, 0, 0.08, 0.05),
     (15.0, 9.2, 1, 0, 0.15, -0.05)]
)  # fmt: skip
"""Feet of routes across and along in m, which way walls look, what routes lean out and aside."""
OFF_WALL_M, HIP_M = 0.35, 1.0  # of tags, from walls and above feet
BETWEEN = {"plywood": (0.13, 2.71, 1.8), "wood": (0.26, 1.99, 1.5), "concrete": (0.12, 5.24, 4.4)}
"""Volumes of plywood, stacks of beams, the tower's core: m, permittivity, dB of each."""
GAIT = ("route", "begun_m", "reach_m", "beat_s", "jerk", "phase", "swing_m", "since_s")
"""How a harness moves, known to nobody."""
OF_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 6.4896  # channel 5
EVENING_S = 6.5 * 3600
PANEL_M = 2.44  # from seam to seam
BRACCIO_M = 0.5836  # da panno, of Florence
LAWS = {
    "chalk-on-tags": Law(("saturation", "logarithm", "power")),
    "gear-hangs-before": Law(("power", "parabola")),
    "seams-passed": Law(("periodic",), PANEL_M, "m", grows=False),
    "destratifiers-run": Law(("step",), 0.107, "m"),
    "sweat-in-straps": Law(("logarithm", "power", "saturation")),
    "air-dries-resin": Law(("linear", "power")),
    "lamps-dimmed": Law(("inverse", "power", "inverse square")),
    "climbers-hang-off": Law(),
    "rope-counter-slips": Law(),
    "means-since-begun": Law(),
    "bolt-turned-out": Law(("position",), 0.44, "m", devices=("bolt5",)),
    "bolts-tagged-alike": Law(("swap",), devices=("bolt2", "bolt8")),
    "braccia-from-one-bolt": Law(("unit",), 1 / BRACCIO_M, "1", grows=False, devices=("bolt10",)),
}
"""What nobody's library has."""


class Slip(NamedTuple):
    """What rows [n] get: metres; dB of all, of first paths, of hiss, and of sums."""

    metres: Floats | float = 0.0
    gain: Floats | float = 0.0
    first: Floats | float = 0.0
    hiss: Floats | float = 0.0
    sums: Floats | float = 0.0


def climbed(gait: dict[str, Floats], at_s: Floats) -> Floats:
    """Return how high harnesses are above a route's foot, in m [n]: by moves with rests between."""

    def moves(turn: Floats) -> Floats:
        part = turn - np.floor(turn)
        eased = np.floor(turn) + part**2 * (3 - 2 * part)
        return np.asarray((1 - gait["jerk"]) * turn + gait["jerk"] * eased)

    gone = moves(at_s / gait["beat_s"] + gait["phase"]) - moves(gait["phase"])
    return np.asarray(gait["begun_m"] + gait["reach_m"] * gone)


def on_route(gait: dict[str, Floats], at_s: Floats) -> Floats:
    """Return where harnesses are [n, 3], in m: up a route, swinging along its wall."""
    x, y, out_x, out_y, lean, aside = ROUTES[gait["route"].astype(np.int64)].T
    high = climbed(gait, at_s)
    off = OFF_WALL_M + lean * high
    turn = 2 * np.pi * gait["phase"]
    along = aside * high + gait["swing_m"] * (np.sin(0.9 * at_s + turn) - np.sin(turn))
    return np.stack(
        [x + out_x * off - out_y * along, y + out_y * off + out_x * along, HIP_M + high], axis=1
    )


@dataclass(frozen=True)
class Ascent:
    """Rows of a table; `season` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    season: int
    rng: np.random.Generator
    few: bool = False

    def of(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name].to_numpy(), np.float64)

    @cached_property
    def apart(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @cached_property
    def bolt(self) -> Whole:
        """Numbers of bolts [n]."""
        return self.table["rx"].str.removeprefix("bolt").to_numpy(np.int64)

    @cached_property
    def harness(self) -> Whole:
        """Numbers of harnesses [n]."""
        return self.table["tx"].str.removeprefix("harness").to_numpy(np.int64)

    @cached_property
    def link(self) -> Whole:
        """Numbers of links [n]."""
        return np.asarray(pd.factorize(self.table["link"])[0], np.int64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1211, what, self.season])

    def each(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return values drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(int(self.link.max()) + 1), np.float64)[self.link]

    def hidden(self, share: float) -> Floats:
        """Return 1 at rows of such a share of links, else 0 [n]."""
        return self.each(lambda n: self.rng.random(n) < share)

    def has(self, kind: str) -> Floats:
        """Return 1 at rows whose straight path goes through such a thing, else 0 [n]."""
        return np.asarray(self.table["obstacles"].map(lambda some: kind in some), np.float64)

    @cached_property
    def tag(self) -> Floats:
        """Where harnesses are said to be [n, 3], in m."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def ear(self) -> Floats:
        """Where bolts are said to be [n, 3], in m."""
        return np.asarray(BOLTS_M[self.bolt])

    def gait(self) -> dict[str, Floats]:
        """Return how harnesses move, [n] each."""
        return {name: self.of(name) for name in GAIT}

    def lengthens(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        gait = self.gait()
        now, then = (on_route(gait, gait["since_s"] + one) for one in (0.0, later_s))
        return self.shifted(then - now)

    def shifted(self, tag_m: Floats, bolt_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer with ends off by [n, 3], in m [n]."""
        return np.asarray(np.linalg.norm(self.tag + tag_m - self.ear - bolt_m, axis=1) - self.apart)

    def walls(self) -> Floats:
        """Return which way walls look that are climbed [n, 3]."""
        looks = ROUTES[self.of("route").astype(np.int64), 2:4]
        return np.column_stack([looks, np.zeros(len(looks))])
