"""The chairlift: pylons up a slope, a rope that sags, a piste, what nobody knows, and rows.

numpy and pandas alone. Chairs hang from a rope on both sides of the pylons and swing; groomers go
up and down a piste beside it. x is along the line and level, y across it, z up.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Ids = NDArray[np.int32]
PYLONS_M: Floats = np.array(
    [(-3.0, 4.6, 4.2), (4.0, 0.9, 10.1), (27.0, -0.9, 17.6), (27.0, 0.9, 12.6), (51.0, 0.9, 24.7),
     (51.0, -0.9, 18.4), (74.0, -0.9, 31.6), (99.0, 0.9, 39.2), (99.0, -0.9, 32.4),
     (120.0, -0.9, 45.3), (127.0, 4.4, 41.0)]
)  # fmt: skip
"""Heads and masts of pylons, and eaves of both stations."""
CHAIRS, GROOMERS = 9, 4
TAGS = [f"chair{k}" for k in range(CHAIRS)] + [f"groomer{k}" for k in range(GROOMERS)]
SADDLES_M: Floats = np.array([-6.0, 4.0, 27.0, 51.0, 74.0, 99.0, 120.0, 131.0])
"""Where along the line the rope lies on sheaves."""
SLOPE, ROPE_M, HANGER_M, CAB_M = 0.3, 8.6, 2.5, 2.9
"""Of the ground; heights above it of the rope, of tags below the rope, of tags on cabs."""
SIDE_M, SAG = 2.7, 0.0013  # of the rope's two halves; m of sag for each m squared of a span
TREES_M = -27.0  # where the wood's edge is, across
LEFT_IN = {"wood": (0.24, 1.99, 2.0), "plywood": (0.14, 2.71, 2.3), "glass": (0.055, 6.31, 1.2)}
"""Snow fences and trunks, huts, bubbles and windscreens: m, permittivity, dB of each."""
WAY = ("rides", "from_m", "pace_mps", "gains_mps2", "lane_m", "swing_m", "beat", "phase", "tick_s")
"""How a tag goes on a trip, which nobody knows."""
METRES_A_PPM = 149.896229  # and second of a reply
WAVE_M = 0.299792458 / 4.4928  # channel 3
DAY_S = 8.25 * 3600
SHEAVE_M = 5.65  # round a wheel
KLAFTER_M = 1.896484  # of Vienna
LAWS = {
    "rime-on-radomes": Law(("power", "parabola")),
    "snow-on-seats": Law(("saturation", "logarithm", "power")),
    "wheel-out-of-round": Law(("periodic",), SHEAVE_M, "m", grows=False),
    "snow-guns-on": Law(("step",), 0.113, "m"),
    "salt-on-hangers": Law(("logarithm", "power", "saturation")),
    "fog-thickens": Law(("inverse", "power", "inverse square")),
    "grease-stiffens": Law(("linear", "power")),
    "chairs-blown-aside": Law(),
    "rope-hangs-lower": Law(),
    "lead-in-the-filter": Law(),
    "pylon-creeps-downhill": Law(("position",), 0.48, "m", devices=("pylon6",)),
    "pylons-hung-with-wrong-plates": Law(("swap",), devices=("pylon3", "pylon5")),
    "klafters-from-one-pylon": Law(("unit",), 1 / KLAFTER_M, "1", grows=False, devices=("pylon4",)),
}
"""What nobody's library has."""
Ill = dict[str, Floats | float]
"""What ails rows: `metres`; dB of the `level`, of the `first` path, of `noise` and of `sums`."""


def ground(x: Floats) -> Floats:
    """Return how high the ground is, in m."""
    return np.asarray(SLOPE * x)


def over_spans(x: Floats) -> tuple[Floats, Floats]:
    """Return how long spans are in m that places are in, and 1 amid them, 0 at saddles [n]."""
    span = np.clip(np.searchsorted(SADDLES_M, x, side="right"), 1, len(SADDLES_M) - 1)
    length = np.diff(SADDLES_M)[span - 1]
    part = (x - SADDLES_M[span - 1]) / length
    return length, np.asarray(4 * part * (1 - part))


def whereabouts(way: dict[str, Floats], tick_s: Floats) -> Floats:
    """Return where tags are [n, 3], in m: swinging below the rope, or on the piste."""
    x = way["from_m"] + way["pace_mps"] * tick_s + way["gains_mps2"] * tick_s**2 / 2
    turn = way["beat"] * tick_s + way["phase"]
    length, amid = over_spans(x)
    fore = way["swing_m"] * np.sin(turn)
    under = np.sqrt(HANGER_M**2 - fore**2)
    chair = [x + fore, way["lane_m"] + 0.3 * way["swing_m"] * np.cos(0.63 * turn),
             ground(x) + ROPE_M - SAG * length**2 * amid - under]  # fmt: skip
    groomer = [x, way["lane_m"] + 2.2 * fore, ground(x) + CAB_M]
    rides = way["rides"] > 0
    return np.stack([np.where(rides, a, b) for a, b in zip(chair, groomer, strict=True)], axis=1)


class Trip:
    """Rows of a table; `winter` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, winter: int, rng: np.random.Generator, scarce: bool = False
    ) -> None:
        self.table, self.winter, self.rng, self.scarce = table, winter, rng, scarce
        self.long: Floats = self.col("true_range_m")
        self.pylon: Ids = np.array([int(one[len("pylon") :]) for one in table["rx"]], np.int32)
        self.who: Ids = np.array([TAGS.index(one) for one in table["tx"]], np.int32)
        self.rides = self.who < CHAIRS
        codes, links = pd.factorize(table["link"])
        self.codes, self.links = codes, len(links)
        self.mast: Floats = PYLONS_M[self.pylon]
        self.seat: Floats = np.stack([self.col(f"tx_{axis}_m") for axis in "xyz"]).T

    def col(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.array(self.table[name], np.float64)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, 1221, self.winter])

    def for_links(self, drawn: Callable[[int], Floats]) -> Floats:
        """Return what is drawn for links, one each, at their rows [n]."""
        return np.asarray(drawn(self.links)[self.codes], np.float64)

    def some(self, share: float) -> Floats:
        """Return 1 at rows of a share of the links, drawn by chance, else 0 [n]."""
        return self.for_links(lambda n: (self.rng.random(n) < share).astype(np.float64))

    def meets(self, kind: str) -> Floats:
        """Return 1 where straight paths meet such a thing, else 0 [n]."""
        return np.fromiter((kind in met for met in self.table["obstacles"]), np.float64)

    def way(self) -> dict[str, Floats]:
        """Return how tags go, [n] each."""
        return {name: self.col(name) for name in WAY}

    def comes_to(self, after_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time after, in m [n]."""
        way = self.way()
        gone = whereabouts(way, way["tick_s"] + after_s) - whereabouts(way, way["tick_s"])
        return self.with_ends(gone)

    def with_ends(self, seat_m: Floats, mast_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer where ends are off by [n, 3], in m [n]."""
        way = self.seat - self.mast + seat_m - mast_m
        return np.asarray(np.sqrt((way**2).sum(axis=1)) - self.long)
