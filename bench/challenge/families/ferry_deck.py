"""The ferry: its car deck, what nobody knows of it, and rows that effects read.

numpy and pandas alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
DECK_M = (56.0, 19.0, 4.7)
LANE_M = 3.0
LANES_M = 1.9 + LANE_M * np.arange(6)  # y of their middles
PILLARS_M = np.array(
    [(4.0, 6.4, 3.9), (13.0, 12.6, 2.6), (22.0, 6.4, 3.1), (31.0, 12.6, 4.2),
     (40.0, 6.4, 2.4), (49.0, 12.6, 3.6), (54.0, 3.0, 2.9), (2.0, 16.0, 4.3)]
)  # fmt: skip
TAGS = 6
BETWEEN = {"glass": (0.021, 6.3, 3.4), "plywood": (0.09, 2.7, 4.6), "wood": (0.16, 2.0, 3.1)}
"""Windows, crates and their frames: thickness in m, permittivity, loss in dB."""
COURSE = ("left_m", "brakes_s")
HALF_LIGHT = 149.896229  # metres per ppm and second
LIGHT = 0.299792458  # metres per nanosecond
CARRIER_GHZ = 6.4896  # channel 5
CARRIER_M = LIGHT / CARRIER_GHZ
YARD_M = 0.9144
LAWS = {
    "tyres-insulate": Law(("linear", "power")),
    "ballast-pumped": Law(("periodic",), 1130.0, "s", grows=False),
    "ramp-let-down": Law(("step",), 0.14, "m"),
    "soaked-tarpaulin": Law(("saturation", "logarithm", "power")),
    "spray-on-lenses": Law(("power", "parabola")),
    "shore-power": Law(("inverse", "power", "inverse square")),
    "deck-heels": Law(),
    "two-ranges-averaged": Law(),
    "lane-out-of-line": Law(),
    "pillar-struck": Law(("position",), 0.498, "m", devices=("pillar5",)),
    "pillars-confused": Law(("swap",), devices=("pillar1", "pillar4")),
    "yards-from-one-pillar": Law(
        ("unit",), 1 / YARD_M, "1", grows=False, devices=("pillar2",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Swell:
    """What comes over rows [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Lading:
    """Rows of a table; `sailing` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    sailing: int
    rng: np.random.Generator
    scarce: bool = False

    def col(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    @property
    def range_m(self) -> Floats:
        """True distances in m [n]."""
        return self.col("true_range_m")

    @property
    def pillar(self) -> NDArray[np.intp]:
        """Numbers of pillars [n]."""
        return self.table["rx"].str.slice(len("pillar")).to_numpy(np.intp)

    @property
    def tag(self) -> NDArray[np.intp]:
        """Numbers of tags [n]."""
        return self.table["tx"].str.slice(len("tag")).to_numpy(np.intp)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, self.sailing, 772])

    def each_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        codes = self.table.groupby("link", sort=False).ngroup().to_numpy()
        return np.asarray(made(int(codes.max()) + 1), np.float64)[codes]

    def cars(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where cars are some time later [n, 3]: they brake into their places."""
        left = self.col("left_m")
        gone = -left * np.expm1(-np.asarray(later_s) / self.col("brakes_s"))
        return np.column_stack([self.col("tx_x_m") + gone, self.col("tx_y_m"), self.col("tx_z_m")])

    def posts(self) -> Floats:
        """Return where the anchors are, as they are written down [n, 3]."""
        return PILLARS_M[self.pillar]

    def off(self, later_s: Floats | float) -> Floats:
        """Return by how much distances change in some time, in m [n]."""
        return np.asarray(np.linalg.norm(self.cars(later_s) - self.posts(), axis=1) - self.range_m)

    def hides(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([float(row.count(kind) > 0) for row in self.table["obstacles"]])
