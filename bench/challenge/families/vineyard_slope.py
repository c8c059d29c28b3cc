"""The vineyard: rows of vines up a slope, stakes among them, what nobody knows of it, and rows.

numpy and pandas alone. Positions are of the slope: x across the rows of vines, y up the slope along
them, z away from it, so that heights are above ground though the ground falls.
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
Numbers = NDArray[np.intp]
PLOT_M = (46.2, 57.0)  # across and up the slope
ALLEY_M, FIRST_ROW_M = 2.2, 1.1  # from one row of vines to the next; where the first one is
CANOPY_M, THICK_M = 1.9, 0.45  # how high and how thick rows of leaves are
STAKES_M: Floats = np.array(
    [(1.1, 3.0, 2.4), (14.3, 1.2, 3.1), (29.7, 2.1, 2.2), (45.1, 4.4, 2.9), (9.9, 20.6, 3.4),
     (34.1, 23.8, 2.6), (20.9, 30.2, 3.2), (3.3, 42.5, 2.7), (25.3, 54.8, 2.3), (42.9, 50.1, 3.3)]
)  # fmt: skip
STAKES, TRACTORS, BASKETS = len(STAKES_M), 3, 5
DEVICES = STAKES + TRACTORS + BASKETS
WALL_M = 60.5  # how far up the slope a wall holds the terrace above
FENCE_X_M = -2.0  # where a fence against boars runs, by the lowest alley
SLOPE_RAD = 0.12
CRATES = {"wood": (0.13, 1.99, 1.5), "concrete": (0.085, 5.24, 2.9), "plywood": (0.05, 2.71, 1.7)}
"""A layer of crates, of cisterns' walls, of huts' boards: m, permittivity, dB of each."""
GAIT = ("pace_m_per_s", "spurt_m", "spurt_rad_per_s", "phase_rad", "sway_m", "bob_m")
MOTION = ("since_s", *(f"{end}_{what}" for end in ("tx", "rx") for what in GAIT))
BUMP_M = 4.4  # from one ridge of tilled soil to the next
M_PER_PPM_S = 149.896229  # for each second of a reply
GHZ = 3.9936  # channel 4
WAVE_M = 0.299792458 / GHZ
PIED_M = 0.3248406  # du roi
DAY_S = 7.2 * 3600  # from before dawn
TOPPED_S = 0.55 * DAY_S
STAY_M = 5.6  # from one iron stay of the trellis to the next
LAWS = {
    "must-on-lids": Law(("saturation", "logarithm", "power")),
    "leaves-wilt": Law(("linear", "power")),
    "trellis-stays-passed": Law(("periodic",), STAY_M, "m", grows=False),
    "hail-net-wets": Law(("step",), 0.105, "m"),
    "baskets-heaped": Law(("power", "parabola")),
    "sulphur-on-foils": Law(("logarithm", "power", "saturation")),
    "stakes-in-moist-soil": Law(("inverse", "power", "inverse square")),
    "rods-hang-plumb": Law(),
    "wheels-slip-downhill": Law(),
    "shoots-topped": Law(),
    "stake-pulled-askew": Law(("position",), 0.52, "m", devices=("stake7",)),
    "stakes-counted-backwards": Law(("swap",), devices=("stake1", "stake8")),
    "pieds-from-one-stake": Law(("unit",), 1 / PIED_M, "1", grows=False, devices=("stake4",)),
}
"""What nobody's library has."""


class Blight(NamedTuple):
    """What befalls rows [n]: metres; dB of the whole, of the first path, of hiss, of counts."""

    metres: Floats
    whole: Floats | float = 0.0
    first: Floats | float = 0.0
    hiss: Floats | float = 0.0
    fewer: Floats | float = 0.0


def gone(gait: pd.DataFrame, at_s: Floats) -> Floats:
    """Return how far devices have gone at times in s [n], [n, 3] in m; `gait` has GAIT.

    Up or down an alley in spurts, beside its middle by a slow sway, and up and down over ridges.
    """
    pace, spurt, rate, phase, sway, bob = (gait[name].to_numpy(np.float64) for name in GAIT)
    turn = rate * at_s + phase
    along = pace * at_s + spurt * (np.sin(turn) - np.sin(phase))
    beside = sway * (np.cos(0.7 * turn) - np.cos(0.7 * phase))
    over = bob * (np.sin(2 * np.pi * along / BUMP_M + phase) - np.sin(phase))
    return np.stack([beside, along, over], axis=1)


@dataclass(frozen=True)
class Harvest:
    """Rows of a table; `vintage` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    vintage: int
    rng: np.random.Generator
    seldom: bool = False

    def of(self, column: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[column], np.float64)

    @cached_property
    def metres(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @cached_property
    def hears(self) -> Numbers:
        """Numbers of receiving devices [n]: stakes, tractors, then baskets."""
        return number_of(self.table["rx"])

    @cached_property
    def calls(self) -> Numbers:
        """Numbers of sending devices [n]: none is a stake."""
        return number_of(self.table["tx"])

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.vintage, 1131, what])

    def by_link(self, drawn: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return a drawn value for each link, at each of its rows [n]."""
        codes, names = pd.factorize(self.table["link"])
        return np.asarray(drawn(len(names)), np.float64)[codes]

    def chosen(self, share: float) -> Floats:
        """Return 1 at all rows of such a share of the links, else 0 [n]."""
        return self.by_link(lambda n: self.rng.random(n) < share)

    def at(self, end: str) -> Floats:
        """Return where an end is known to be [n, 3], in m."""
        return np.asarray(self.table[[f"{end}_{axis}_m" for axis in "xyz"]], np.float64)

    def went(self, end: str, later_s: Floats | float = 0.0) -> Floats:
        """Return how far an end has gone some time later since its pass began [n, 3], in m."""
        gait = pd.DataFrame({name: self.table[f"{end}_{name}"] for name in GAIT})
        return gone(gait, self.of("since_s") + later_s)

    def onward(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        ends = [self.at(end) + self.went(end, later_s) - self.went(end) for end in ("tx", "rx")]
        return np.asarray(np.linalg.norm(ends[1] - ends[0], axis=1) - self.metres)

    def moved(self, tx: Floats, rx: Floats) -> Floats:
        """Return by how much ways are longer with ends elsewhere by [n, 3], in m [n]."""
        apart = self.at("rx") + rx - self.at("tx") - tx
        return np.asarray(np.linalg.norm(apart, axis=1) - self.metres)

    def stands(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([1.0 if kind in some else 0.0 for some in self.table["obstacles"]])

    @cached_property
    def crossed(self) -> Floats:
        """How many rows of vines straight paths cross [n], below their tops or above."""
        alley = [np.floor((self.at(end)[:, 0] - FIRST_ROW_M) / ALLEY_M) for end in ("tx", "rx")]
        return np.asarray(np.abs(alley[1] - alley[0]))

    @cached_property
    def leaves(self) -> Floats:
        """How many m of leaves straight paths go through [n]: aslant, and only below the tops."""
        ends = np.stack([self.at("tx")[:, 2], self.at("rx")[:, 2]])
        low, high = ends.min(axis=0), np.maximum(ends.max(axis=0), ends.min(axis=0) + 1e-3)
        below = np.clip((CANOPY_M - low) / (high - low), 0.0, 1.0)
        across = np.abs(self.at("rx")[:, 0] - self.at("tx")[:, 0])
        aslant = self.metres / np.maximum(across, 0.25 * self.metres)
        return np.asarray(self.crossed * THICK_M * aslant * below)


def number_of(devices: pd.Series) -> Numbers:
    """Return numbers of devices [n]: stakes, tractors, then baskets."""
    before = {"stake": 0, "tractor": STAKES, "basket": STAKES + TRACTORS}
    kinds = devices.str.rstrip("0123456789")
    own = devices.str.lstrip("abcdefghijklmnopqrstuvwxyz").astype(int)
    return np.asarray(kinds.map(before) + own, np.intp)


def name_of(number: int) -> str:
    """Return what a device is called."""
    if number < STAKES:
        return f"stake{number}"
    tractor = number - STAKES
    return f"tractor{tractor}" if tractor < TRACTORS else f"basket{tractor - TRACTORS}"
