"""The signal box's yard: semaphores over sidings, what nobody knows of it, rows that effects read.

numpy and pandas alone. Three sidings that fan out a little, on ballast, in the open; wagons roll
down them by themselves, and retarders between the rails brake them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
WIDE_M, LONG_M = 24.0, 60.0
SEMAPHORES_M = np.array(
    [(1.1, 4.0, 5.2), (8.7, 1.5, 7.4), (15.6, 3.8, 6.1), (22.8, 12.4, 4.8), (8.3, 22.1, 6.6),
     (15.9, 29.7, 5.0), (0.8, 33.2, 7.9), (22.9, 41.0, 6.3), (8.6, 47.3, 5.5), (15.4, 57.6, 7.0)]
)  # fmt: skip
HEARD = 6  # semaphores that hear a run
WAGONS = 8
SIDINGS = np.array([(5.0, -0.05, 0.105), (12.0, 0.0, -0.06), (19.0, 0.05, 0.085)])
"""Where sidings begin across the yard in m, their bearings and their cants in radians."""
BETWEEN = {"wood": (0.06, 1.99, 1.5), "brick": (0.11, 3.91, 4.4), "concrete": (0.09, 5.24, 4.9)}
"""Sides of wagons, platelayers' huts, posts and slabs: m, permittivity, dB of each."""
ROLL = ("siding", "bearing_rad", "entry_m_per_s", "exit_m_per_s", "gripped_s")
GRIPS_S = 0.5  # in which a retarder takes hold
PPM_SECOND_M = 299.792458 / 2  # metres per ppm and second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 2
ROD_M = 5.0292
BELL_S = 1150.0  # between the bells by which clocks are set
TURN_S = 8.5 * 3600
LAWS = {
    "grease-on-domes": Law(("power", "parabola")),
    "rail-joints": Law(("periodic",), 11.9, "m", grows=False),
    "point-heaters-on": Law(("step",), 0.132, "m"),
    "coal-dust": Law(("saturation", "logarithm", "power")),
    "frost-on-arms": Law(("logarithm", "power", "saturation")),
    "wires-lengthen-in-sun": Law(("linear", "power")),
    "ballast-conducts": Law(("inverse", "power", "inverse square")),
    "cant-forgotten": Law(),
    "retarders-underrated": Law(),
    "clocks-run-between-bells": Law(),
    "semaphore-struck": Law(("position",), 0.555, "m", devices=("semaphore7",)),
    "semaphores-renamed": Law(("swap",), devices=("semaphore3", "semaphore8")),
    "rods-from-one-semaphore": Law(
        ("unit",), 1 / ROD_M, "1", grows=False, devices=("semaphore1",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Change:
    """What changes in rows [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


def rolled(entry: Floats | float, leaving: Floats | float, gripped_s: Floats) -> Floats:
    """Return how far wagons roll from such speeds to such others, since they are gripped, in m."""
    return np.asarray(entry * gripped_s - (entry - leaving) * braked(gripped_s))


def braked(gripped_s: Floats) -> Floats:
    """Return for how long, in effect, retarders have braked [n], in s: a smooth corner."""
    return np.asarray(GRIPS_S * np.logaddexp(0.0, gripped_s / GRIPS_S))


def _numbers(names: pd.Series, kind: str) -> NDArray[np.intp]:
    """Return the numbers at the end of names of devices of a kind [n]."""
    return np.array([int(name[len(kind) :]) for name in names], np.intp)


class Train:
    """Rows of a table; `day` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, day: int, rng: np.random.Generator, scarce: bool = False
    ) -> None:
        self.table, self.day, self.rng, self.scarce = table, day, rng, scarce
        self.size = len(table)
        self.far = self.column("true_range_m")
        self.semaphore = _numbers(table["rx"], "semaphore")
        self.wagon = _numbers(table["tx"], "wagon")

    def column(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64, copy=True)

    def kept(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([902, what, self.day])

    def per_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        number = self.table.groupby("link", sort=False).ngroup().to_numpy()
        return np.asarray(made(int(number.max()) + 1), np.float64)[number]

    def arms(self) -> Floats:
        """Return where semaphores have their antennas, as is written down [n, 3], in m."""
        return SEMAPHORES_M[self.semaphore]

    def ahead(self) -> Floats:
        """Return which way sidings lead [n, 3]."""
        bearing = self.column("bearing_rad")
        return np.stack([np.sin(bearing), np.cos(bearing), np.zeros(self.size)], axis=1)

    def tags(self, after_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later: rolled on, and braked [n, 3], in m."""
        entry, leaving, gripped = (self.column(name) for name in ROLL[2:])
        gone = rolled(entry, leaving, gripped + after_s) - rolled(entry, leaving, gripped)
        here = self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)
        return np.asarray(here + gone[:, None] * self.ahead())

    def more(self, after_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.more_from(self.tags(after_s))

    def more_from(self, tags_m: Floats) -> Floats:
        """Return by how much ways from tags at [n, 3] are longer, in m [n]."""
        return np.asarray(np.sqrt(np.sum((tags_m - self.arms()) ** 2, axis=1)) - self.far)

    def through(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return self.table["obstacles"].map(lambda some: kind in some).to_numpy(np.float64)
