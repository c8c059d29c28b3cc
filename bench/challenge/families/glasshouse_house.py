"""The glasshouse: gutters and rows of plants, what nobody knows of it, and rows that effects read.

numpy and pandas alone. A Venlo house of wide panes, with spans of 4.8 m (NEN-EN 13031-1).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
HOUSE_M = (33.6, 24.0, 5.4)
ROW_M = 1.6  # from one row of plants to the next; rows run along y
GUTTERS_M = np.array(
    [(2.4, 4.1, 4.2), (7.2, 19.3, 3.5), (12.0, 7.6, 4.7), (16.8, 21.8, 3.9),
     (21.6, 2.2, 4.4), (26.4, 14.9, 3.3), (31.2, 22.7, 4.6)]
)  # fmt: skip
TROLLEYS = 5
PARTS = {"glass": (0.026, 6.31, 3.0), "chipboard": (0.13, 2.58, 3.7), "brick": (0.1, 3.91, 5.2)}
"""Partitions, cupboards of seed, a wall of services: thickness in m, permittivity, loss in dB."""
STROKE = ("push_m_per_s", "beat_rad_per_s", "beat_rad")
DEPTH = 0.7  # of the beat in a speed
PPM_M = 149.896229  # metres per ppm and second, one way
LIGHT = 0.299792458  # metres per nanosecond
CARRIER_GHZ = 3.9936  # channel 2
CARRIER_M = LIGHT / CARRIER_GHZ
CABLE = 0.82  # of the speed of light, in a foamed coaxial cable
LAWS = {
    "leaf-film": Law(("power", "parabola")),
    "screen-drawn": Law(("step",), 0.12, "m"),
    "fogging-turns": Law(("periodic",), 610.0, "s", grows=False),
    "sap-in-fruit": Law(("saturation", "logarithm", "power")),
    "pipes-heated": Law(("linear", "power")),
    "algae-on-panes": Law(("logarithm", "power", "saturation")),
    "lamps-dimmed": Law(("inverse", "power", "inverse square")),
    "canopy-closes": Law(),
    "odometer-slips": Law(),
    "longer-of-two-kept": Law(),
    "gutter-unhooked": Law(("position",), 0.46, "m", devices=("gutter2",)),
    "gutters-transposed": Law(("swap",), devices=("gutter1", "gutter5")),
    "speed-of-cable-in-one-gutter": Law(
        ("unit",), CABLE, "1", grows=False, devices=("gutter4",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Growth:
    """What grows on rows [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Crop:
    """Rows of a table; `season` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    season: int
    rng: np.random.Generator
    thin: bool = False

    def of(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name].to_numpy(), dtype=np.float64)

    @property
    def size(self) -> int:
        """How many rows there are."""
        return int(self.table.shape[0])

    @property
    def way_m(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    def device(self, end: str) -> NDArray[np.intp]:
        """Return the numbers of gutters (`rx`) or of trolleys (`tx`) [n]."""
        return np.array(
            [int(name.lstrip("abcdefghijklmnopqrstuvwxyz")) for name in self.table[end]]
        )

    def sown(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([812, what, self.season])

    def per_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        codes, names = pd.factorize(self.table["link"])
        return np.asarray(made(len(names)))[codes].astype(np.float64)

    def tags(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where trolleys are some time later: pushed along, with a beat [n, 3]."""
        push, rate, phase = (self.of(name) for name in STROKE)
        beats = (np.sin(phase + rate * later_s) - np.sin(phase)) / rate
        at = np.array([self.of(f"tx_{axis}_m") for axis in "xyz"]).T
        at[:, 1] += push * (later_s - DEPTH * beats)
        return at

    def hooks(self) -> Floats:
        """Return where gutters hang, as it is written down [n, 3]."""
        return GUTTERS_M[self.device("rx")]

    def grown(self, later_s: Floats | float) -> Floats:
        """Return by how much distances grow in some time, in m [n]."""
        apart = np.square(self.tags(later_s) - self.hooks()).sum(axis=1)
        return np.asarray(np.sqrt(apart) - self.way_m)

    def rows_crossed(self) -> Floats:
        """Return how many rows of plants a way crosses [n]."""
        return np.asarray(np.abs(self.of("tx_x_m") - self.of("rx_x_m")) / ROW_M)

    def behind(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.asarray(self.table["obstacles"].map(lambda row: kind in row), np.float64)
