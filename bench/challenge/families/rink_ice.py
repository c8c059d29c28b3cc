"""The rink: trusses above ice, what nobody knows of it, and rows that effects read.

numpy and pandas alone. A small ice hall: boards of plastic with panes on them, a roof on trusses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
RINK_M = (27.0, 41.0, 7.6)
TRUSSES_M = np.array(
    [(1.5, 3.0, 4.3), (13.2, 1.2, 6.1), (25.4, 6.8, 4.9), (25.9, 22.5, 5.6),
     (24.1, 39.2, 4.5), (9.4, 39.8, 6.4), (0.9, 24.7, 5.2)]
)  # fmt: skip
RACK_M = np.array([27.0, 0.0])  # where all feeders end
CHILLER_M = np.array([0.0, 41.0])
SKATERS = 5
BARRIERS = {"glass": (0.03, 6.31, 2.9), "wood": (0.11, 1.99, 2.2), "concrete": (0.085, 5.24, 5.4)}
"""Panes, benches, posts of the stand: thickness in m, permittivity, loss in dB."""
GLIDE = ("arc_m", "heading_rad", "speed_m_per_s")
SLOWS_S = 6.0  # in which a glide loses all but 1/e of its speed
REPLY_M = 149.896229  # metres per ppm and second of a reply
CARRIER_M = 0.299792458 / 6.4896  # channel 5
HEAD_M = 1.55  # of a tag above blades
GRAVITY = 9.81
PERIOD_S = 730.0
LAWS = {
    "visor-fogs": Law(("power", "parabola")),
    "drier-cycles": Law(("periodic",), PERIOD_S, "s", grows=False),
    "second-brine-pump": Law(("step",), 0.125, "m"),
    "spectators-rise": Law(("saturation", "logarithm", "power")),
    "rime-on-trusses": Law(("logarithm", "power", "saturation")),
    "floodlights-burn": Law(("linear", "power")),
    "cell-sags-in-cold": Law(("inverse", "power", "inverse square")),
    "blades-lean": Law(),
    "coasts-on-speed": Law(),
    "truss-rehung": Law(("position",), 0.49, "m", devices=("truss5",)),
    "trusses-swapped": Law(("swap",), devices=("truss0", "truss3")),
    "counter-of-another-clock": Law(
        ("unit",), 499.2 / 512, "1", grows=False, devices=("truss2",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Cut:
    """What is cut into rows [n]: metres; dB of the whole, of the edge, of hiss, of the count."""

    metres: Floats
    whole: Floats | float = 0.0
    edge: Floats | float = 0.0
    hiss: Floats | float = 0.0
    count: Floats | float = 0.0


@dataclass(frozen=True)
class Sheet:
    """Rows of a table; `night` seeds what all tables of a case share, `rng` all else."""

    table: pd.DataFrame
    night: int
    rng: np.random.Generator
    few: bool = False

    def __getitem__(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    @property
    def d(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    def number(self, end: str) -> NDArray[np.intp]:
        """Return the numbers of trusses (`rx`) or of skaters (`tx`) [n]."""
        return self.table[end].str.extract(r"(\d+)$")[0].to_numpy().astype(np.intp)

    def frozen(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([851, self.night, what])

    def by_link(self, made: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return one made value for each link, at each of its rows [n]."""
        place, links = pd.factorize(self.table["link"])
        return np.asarray(made(len(links)), np.float64)[place]

    def helmets(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later: on arcs, ever slower [n, 3], in m."""
        arc, heading, speed = (self[name] for name in GLIDE)
        gone = speed * SLOWS_S * -np.expm1(-np.asarray(later_s) / SLOWS_S)
        after = heading + gone / arc
        at = np.stack([self[f"tx_{axis}_m"] for axis in "xyz"], axis=1)
        at[:, 0] += arc * (np.sin(after) - np.sin(heading))
        at[:, 1] += arc * (np.cos(heading) - np.cos(after))
        return at

    def ends(self) -> Floats:
        """Return where antennas hang, as it is written down [n, 3], in m."""
        return TRUSSES_M[self.number("rx")]

    def gone(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.seen_at(self.helmets(later_s))

    def seen_at(self, helmets: Floats) -> Floats:
        """Return by how much ways are longer were tags at places [n, 3], in m [n]."""
        return np.asarray(np.linalg.norm(helmets - self.ends(), axis=1) - self.d)

    def behind(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.array([float(kind in one) for one in self.table["obstacles"]])
