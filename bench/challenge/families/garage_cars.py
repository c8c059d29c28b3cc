"""The garage: two cars with anchors, walls near by, what nobody knows of it, and rows of effects.

numpy and pandas alone. Anchors of an estate and of a van ask the phones of people who walk up to
them, from rest to rest, or stand about. What is in the way follows from which side an anchor is on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
GARAGE_M = (15.2, 9.8, 2.75)
ANCHORS_M: Floats = np.array(
    [(3.5, 2.35, 0.52), (5.15, 2.45, 0.61), (4.3, 6.95, 0.83), (4.25, 5.6, 1.52), (4.6, 4.1, 1.02),
     (10.55, 2.25, 0.74), (9.55, 5.35, 1.38), (11.58, 4.95, 1.21), (10.5, 7.6, 1.63)]
)  # fmt: skip
FACING: Floats = np.array(
    [(-0.6, -0.8), (0.6, -0.8), (0.0, 1.0), (0.0, 0.3), (0.2, -0.1), (0.0, -1.0), (-1.0, 0.0),
     (1.0, 0.0), (0.0, 1.0)]
)  # fmt: skip
"""Which way anchors look: a length of 1 says that its car is all that is behind it."""
CARS_M = ((3.4, 5.25, 2.3, 7.0), (9.5, 11.65, 2.2, 7.65))  # from, to along x, and along y
UNITS_M: Floats = np.array([(4.3, 3.6, 0.8), (10.6, 3.2, 0.9)])  # what anchors are wired to
OF_CAR = np.array([0, 0, 0, 0, 0, 1, 1, 1, 1])
PHONES = 7
BETWEEN = {"concrete": (0.26, 5.24, 7.0), "glass": (0.03, 6.31, 2.4), "plywood": (0.07, 2.71, 2.9)}
"""Pillars, windows that are met aslant, what lines a van: m, permittivity, dB of each."""
STRIDE = ("ahead_rad", "walk_m", "walk_s", "gone_s")
PPM_M = 149.896229  # metres for each second of a reply and millionth
WAVE_M = 0.299792458 / 7.9872  # channel 9
AFTERNOON_S = 5.5 * 3600
STEP_M = 1.47  # two steps: from one swing of an arm to the next
LAWS = {
    "rain-on-paint": Law(("saturation", "logarithm", "power")),
    "hotspot-shares-the-air": Law(("power", "parabola")),
    "arms-swing": Law(("periodic",), STEP_M, "m", grows=False),
    "doors-opened": Law(("step",), 0.108, "m"),
    "sun-on-dashboards": Law(("logarithm", "power", "saturation")),
    "hands-cover": Law(("linear", "power")),
    "charge-runs-out": Law(("inverse", "power", "inverse square")),
    "steps-counted-short": Law(),
    "ranges-rise-slowly": Law(),
    "anchor-clip-broken": Law(("position",), 0.43, "m", devices=("anchor7",)),
    "anchors-flashed-wrongly": Law(("swap",), devices=("anchor2", "anchor8")),
    "quarters-from-one-anchor": Law(("unit",), 4.0, "1", grows=False, devices=("anchor4",)),
}
"""What nobody's library has."""
Wrong = dict[str, Floats]
"""What goes wrong at rows [n]: `metres`, dB of `whole` signals, of `edge`, `hiss` and `count`."""


def reached(walk_m: Floats, walk_s: Floats, at_s: Floats) -> Floats:
    """Return how far in m people have walked at times [n] of walks [n] from rest to rest.

    With least jerk (Flash and Hogan 1985).
    """
    part = np.clip(at_s / walk_s, 0.0, 1.0)
    return np.asarray(walk_m * part**3 * (10 - 15 * part + 6 * part**2))


class Visit:
    """Rows of a table; `afternoon` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, afternoon: int, rng: np.random.Generator, seldom: bool = False
    ) -> None:
        self.table, self.afternoon, self.rng, self.seldom = table, afternoon, rng, seldom
        self.off: Floats = self["true_range_m"]
        self.anchor, self.phone = (
            table[end].str[-1].astype(np.intp).to_numpy() for end in ("tx", "rx")
        )
        self.links, self.of_link = np.unique(table["link"].to_numpy(str), return_inverse=True)

    def __getitem__(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64, copy=True)

    def always(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1042, what, self.afternoon])

    def each_link(self, draw: Callable[..., Any], *how: float) -> Floats:
        """Return one drawn value for each link, at each of its rows [n]."""
        return np.asarray(draw(*how, len(self.links)), np.float64)[self.of_link]

    def unseen(self, share: float) -> Floats:
        """Return 1 at rows of such a share of the links without line of sight, else 0 [n]."""
        luck = self.each_link(self.rng.uniform, 0.0, 1.0)
        return np.where((luck < share) & ~self.table["los"].to_numpy(bool), 1.0, 0.0)

    def senders(self) -> Floats:
        """Return where anchors have their antennas, as is written down [n, 3], in m."""
        return ANCHORS_M[self.anchor]

    def phones(self, later_s: Floats | float = 0.0, stretch: float = 1.0) -> Floats:
        """Return where phones are some time later [n, 3], in m; `stretch`: of what was walked."""
        place = np.stack([self[f"rx_{axis}_m"] for axis in "xyz"], axis=1)
        if not np.any(later_s) and stretch == 1.0:
            return place
        ahead, walk_m, walk_s, gone_s = (self[name] for name in STRIDE)
        more = stretch * reached(walk_m, walk_s, gone_s + later_s) - reached(walk_m, walk_s, gone_s)
        place[:, :2] += more[:, None] * np.stack([np.cos(ahead), np.sin(ahead)], axis=1)
        return place

    def grown(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.grown_to(self.phones(later_s))

    def grown_to(self, phones_m: Floats) -> Floats:
        """Return by how much ways to phones at [n, 3] are longer, in m [n]."""
        return np.asarray(np.sqrt(((phones_m - self.senders()) ** 2).sum(axis=1)) - self.off)

    def past(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.where([kind in some for some in self.table["obstacles"]], 1.0, 0.0)
