"""The foundry: a bay of columns, cranes above it, what nobody knows of it, and rows of effects.

numpy and pandas alone. Bridges of cranes run along the bay; their hooks hang on long ropes and
swing. Columns of steel carry receivers, and hooks hear each other.
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
Places = NDArray[np.intp]
BAY_M = (22.0, 68.0, 12.4)
TROLLEY_M = 10.9  # how high ropes begin
GIRDER_M = 11.5  # of the bridges' lower sides
COLUMNS_M: Floats = np.array(
    [(0.9, 4.8, 3.1), (21.2, 9.6, 2.3), (0.7, 19.5, 4.4), (21.0, 24.1, 2.8), (0.9, 33.7, 2.2),
     (21.3, 38.9, 4.1), (0.8, 48.2, 3.6), (21.1, 53.4, 2.6), (11.0, 67.1, 4.7)]
)  # fmt: skip
CRANES, HUNG = 4, len(COLUMNS_M)
FURNACES_M = np.array([(4.0, 12.0), (17.5, 30.0)])
STACKS = {"brick": (0.24, 3.91, 5.2), "concrete": (0.2, 5.24, 6.0), "chipboard": (0.14, 2.58, 2.7)}
"""Linings that wait, walls of pits, patterns on shelves: m, permittivity, dB of each."""
SWINGS = ("rope_m", "run_m_per_s", "swing_m", "sway_m", "phase_rad")
MOTION = ("since_s", *(f"{end}_{what}" for end in ("tx", "rx") for what in SWINGS))
GRAVITY = 9.81
METRES_PER_PPM_S = 149.896229  # for each second of a reply
CARRIER_M = 0.299792458 / 3.9936  # channel 4
CUBIT_M = 0.4572
SHIFT_S = 8.5 * 3600
BLAST_S = 428.0  # from one start of the shot blaster to the next
LAWS = {
    "slag-crusts": Law(("saturation", "logarithm", "power")),
    "lining-heats": Law(("power", "parabola")),
    "shot-blaster-cycles": Law(("periodic",), BLAST_S, "s", grows=False),
    "magnet-energised": Law(("step",), 0.097, "m"),
    "graphite-settles": Law(("logarithm", "power", "saturation")),
    "sand-dries": Law(("linear", "power")),
    "covers-touch-domes": Law(("inverse", "power", "inverse square")),
    "hooks-swing-less": Law(),
    "braking-way-taken-off": Law(),
    "column-backed-into": Law(("position",), 0.47, "m", devices=("column3",)),
    "columns-crosswired": Law(("swap",), devices=("column0", "column5")),
    "cubits-from-one-column": Law(("unit",), 1 / CUBIT_M, "1", grows=False, devices=("column6",)),
}
"""What nobody's library has."""


class Flaw(NamedTuple):
    """What is wrong with rows [n]: metres; dB of all there is, of edges, of noise, of counts."""

    metres: Floats
    all_db: Floats | float = 0.0
    edge_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def hangs(swing: pd.DataFrame, at_s: Floats) -> Floats:
    """Return where hooks are beside where their bridges were at the start [n, 3], in m.

    A spherical pendulum that swings little, below a bridge that runs evenly; `swing` has SWINGS.
    """
    rope, run, across, along, phase = (swing[name].to_numpy(np.float64) for name in SWINGS)
    turn = np.sqrt(GRAVITY / rope) * at_s + phase
    x, y = across * np.cos(turn), along * np.sin(turn)
    return np.stack([x, y + run * at_s, (x * x + y * y) / (2 * rope)], axis=1)


@dataclass(frozen=True)
class Pour:
    """Rows of a table; `shift` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    shift: int
    rng: np.random.Generator
    scarce: bool = False

    def get(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name], np.float64)

    @cached_property
    def way(self) -> Floats:
        """True distances in m [n]."""
        return self.get("true_range_m")

    @cached_property
    def ear(self) -> Places:
        """Numbers of receiving devices [n]: columns, then hooks."""
        return _numbers(self.table["rx"])

    @cached_property
    def mouth(self) -> Places:
        """Numbers of sending devices [n], all of them hooks."""
        return _numbers(self.table["tx"])

    @cached_property
    def link(self) -> Places:
        """Numbers of links [n], from 0."""
        return np.asarray(pd.factorize(self.table["link"])[0], np.intp)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.shift, 1021, what])

    def for_links(self, draw: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return a drawn value of each link, at all of its rows [n]."""
        return np.asarray(draw(int(self.link.max()) + 1), np.float64)[self.link]

    def some_links(self, share: float) -> Floats:
        """Return 1 at all rows of such a share of the links, else 0 [n]."""
        return self.for_links(lambda n: np.less(self.rng.random(n), share).astype(np.float64))

    def place(self, end: str, later_s: Floats | float = 0.0, swung: float = 1.0) -> Floats:
        """Return where an end is some time later [n, 3], in m: hooks run and swing on.

        `swung`: times as far as is known.
        """
        here = self.table[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64, copy=True)
        if not np.any(later_s) and swung == 1.0:
            return here
        known = pd.DataFrame({what: self.table[f"{end}_{what}"] for what in SWINGS})
        truly = known.assign(swing_m=swung * known["swing_m"], sway_m=swung * known["sway_m"])
        since = self.get("since_s")
        return np.asarray(here - hangs(known, since) + hangs(truly, since + later_s))

    def longer(self, later_s: Floats | float, swung: float = 1.0) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        apart = self.place("tx", later_s, swung) - self.place("rx", later_s, swung)
        return np.asarray(np.linalg.norm(apart, axis=1) - self.way)

    def has(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([float(kind in some) for some in self.table["obstacles"]])


def _numbers(devices: pd.Series) -> Places:
    """Return numbers of devices [n]: those of hooks follow those of columns."""
    own = devices.str.extract(r"(\d+)$")[0].astype(int)
    return np.asarray(own + np.where(devices.str.startswith("hook"), HUNG, 0), np.intp)
