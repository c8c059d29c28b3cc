"""The cowshed: rafters over cubicles, what nobody knows of it, and rows that effects read.

numpy and pandas alone. One long shed below a gabled roof of steel: an alley for feed along the
middle, cubicles on both sides of it, a floor of slats, curtains in place of the long walls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
SHED_M = (22.0, 44.0, 7.2)
RIDGE_M, FALL = 11.0, 0.29  # where the roof is highest, and how it falls to both sides
RAFTERS_M = np.array(
    [(3.1, 2.2, 3.4), (18.6, 5.1, 4.1), (10.2, 12.3, 6.2), (2.4, 18.7, 3.8), (19.7, 24.4, 3.5),
     (11.6, 29.9, 5.9), (3.3, 36.2, 4.4), (18.1, 42.0, 3.2)]
)  # fmt: skip
COWS = 9
WALLS = {"concrete": (0.1, 5.24, 5.3), "brick": (0.115, 3.91, 4.2), "wood": (0.15, 1.99, 2.4)}
"""Sills of mangers, the milking parlour, partitions: m, permittivity, dB of each."""
WATER = 78.0  # permittivity
GAIT = ("heading_rad", "step_m_per_s", "halt_s")
M_PER_PPM_S = 149.896229  # for each second of a reply
WAVE_M = 0.299792458 / 6.4896  # channel 5
VARA_M = 0.8359
DAY_S = 10.0 * 3600
SCRAPE_S = 660.0  # from one start of the scrapers to the next
LAWS = {
    "muck-on-domes": Law(("saturation", "logarithm", "power")),
    "straw-piles-up": Law(("power", "parabola")),
    "scrapers-run": Law(("periodic",), SCRAPE_S, "s", grows=False),
    "curtain-lowered": Law(("step",), 0.131, "m"),
    "breath-condenses": Law(("logarithm", "power", "saturation")),
    "mangers-filled": Law(("linear", "power")),
    "collars-hang": Law(("inverse", "power", "inverse square")),
    "heads-lowered": Law(),
    "changes-underrated": Law(),
    "rafter-lifted": Law(("position",), 0.53, "m", devices=("rafter4",)),
    "rafters-misnumbered": Law(("swap",), devices=("rafter2", "rafter6")),
    "varas-from-one-rafter": Law(("unit",), 1 / VARA_M, "1", grows=False, devices=("rafter1",)),
}
"""What nobody's library has."""


class Trouble(NamedTuple):
    """What befalls rows [n]: metres; dB of all there is, of the edge, of noise, of the count."""

    metres: Floats
    all_db: Floats | float = 0.0
    edge_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def walked(step: Floats, halt_s: Floats, after_s: Floats | float) -> Floats:
    """Return how far in m cows get that slow down exponentially, from so many m/s [n]."""
    return np.asarray(-step * halt_s * np.expm1(-np.asarray(after_s) / halt_s))


@dataclass(frozen=True)
class Herd:
    """Rows of a table; `season` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    season: int
    rng: np.random.Generator
    scarce: bool = False

    @property
    def size(self) -> int:
        """How many rows there are."""
        return self.table.shape[0]

    def col(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64, copy=True)

    @property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.col("true_range_m")

    @property
    def rafter(self) -> NDArray[np.intp]:
        """Numbers of rafters [n]."""
        return self.table["rx"].str.removeprefix("rafter").to_numpy().astype(np.intp)

    @property
    def cow(self) -> NDArray[np.intp]:
        """Numbers of cows [n]."""
        return self.table["tx"].str.removeprefix("cow").to_numpy().astype(np.intp)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([962, self.season, what])

    def per_link(self, draw: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one drawn value for each link, at each of its rows [n]."""
        number = self.table.groupby("link", sort=False).ngroup().to_numpy(np.intp)
        return np.asarray(draw(int(number.max()) + 1), np.float64)[number]

    def aerials(self) -> Floats:
        """Return where rafters have their antennas, as is written down [n, 3], in m."""
        return RAFTERS_M[self.rafter]

    def collars(self, after_s: Floats | float = 0.0) -> Floats:
        """Return where collars are some time later, ever slower by then [n, 3], in m."""
        heading, step, halt_s = map(self.col, GAIT)
        there = self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64, copy=True)
        gone = walked(step, halt_s, after_s)
        there[:, 0] += gone * np.cos(heading)
        there[:, 1] += gone * np.sin(heading)
        return there

    def farther(self, after_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.farther_from(self.collars(after_s))

    def farther_from(self, collars_m: Floats) -> Floats:
        """Return by how much ways from collars at [n, 3] are longer, in m [n]."""
        return np.asarray(np.linalg.norm(self.aerials() - collars_m, axis=1) - self.far)

    def crosses(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return self.table["obstacles"].map(lambda some: kind in some).to_numpy(np.float64)

    def first_of_its_link(self) -> Floats:
        """Return the range in m that each row's link had first, in its own copy of the rows [n]."""
        copy = self.table.groupby(["link", "time_s"]).cumcount()
        return self.table.groupby(["link", copy])["range_m"].transform("first").to_numpy(np.float64)
