"""The fairground: rides that turn, booths about them, what nobody knows of them, rows of effects.

numpy and pandas alone. On a meadow a wheel stands upright, two rides lie flat, and wagons are
parked along the sides; tags hang in gondolas, which go round.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
BOOTHS_M: Floats = np.array(
    [(4.2, 5.6, 2.7), (23.7, 2.9, 3.3), (42.4, 7.7, 2.1), (44.8, 25.1, 4.4), (34.6, 39.3, 2.9),
     (15.3, 37.6, 3.6), (2.7, 22.4, 2.4)]
)  # fmt: skip
HUBS_M = np.array([(28.0, 26.0, 9.6), (12.5, 28.5, 1.0), (33.0, 11.0, 1.8)])
AXLES = np.array([(0.6, 0.8, 0.0), (0.0, 0.0, 1.0), (0.14, 0.0, 0.99)])
AXLES /= np.linalg.norm(AXLES, axis=1, keepdims=True)
RADII_M = np.array([8.0, 4.6, 5.7])
RIDES = ("wheel", "roundabout", "tilted whirl")
GONDOLAS = 8
GENERATORS_M = np.array([(1.0, 12.0), (46.5, 16.0), (25.0, 41.0)])
FLANKS = (
    (0, 1.5, 8.0, 20.0, 3.6), (0, 46.0, 10.0, 22.0, 3.9), (0, 46.8, 28.0, 40.0, 3.9),
    (1, 1.2, 6.0, 21.0, 3.6), (1, 0.8, 26.0, 40.0, 4.0), (1, 41.0, 17.0, 33.0, 3.9),
)  # fmt: skip
"""Wagons' sides of steel: the axis that they are upright to, where, from, to, how high, in m."""
BARRIERS = {"concrete": (0.15, 5.24, 5.0), "wood": (0.16, 1.99, 2.2), "glass": (0.035, 6.31, 2.1)}
"""Blocks that hold rides down, floors and fronts, a maze of mirrors: m, permittivity, dB."""
TURNING = ("ride", "spin_rad_per_s")
HALF_C = 149.896229  # metres per ppm and second of a reply
CYCLE_M = 0.299792458 / 3.4944  # channel 1
TRODDEN_S_PER_M = 0.3  # conductivity of a wet meadow
SAZHEN_M = 2.1336
EVENING_S = 8.0 * 3600
TUNE_S = 318.0  # from one turn of the organ's book to the next
LAWS = {
    "canvas-soaks": Law(("saturation", "logarithm", "power")),
    "crowd-gathers": Law(("power", "parabola")),
    "organ-plays": Law(("periodic",), TUNE_S, "s", grows=False),
    "awning-let-down": Law(("step",), 0.128, "m"),
    "sugar-settles": Law(("logarithm", "power", "saturation")),
    "bunting-hung": Law(("linear", "power")),
    "ground-gives-way": Law(("inverse", "power", "inverse square")),
    "wheel-set-askew": Law(),
    "louder-of-two-kept": Law(),
    "booth-shoved": Law(("position",), 0.54, "m", devices=("booth4",)),
    "booths-mistaken": Law(("swap",), devices=("booth1", "booth5")),
    "sazhens-from-one-booth": Law(("unit",), 1 / SAZHEN_M, "1", grows=False, devices=("booth2",)),
}
"""What nobody's library has."""


class Stall:
    """What is dealt out to rows [n]: metres, dB of signals, of first ones, of hiss, of counts."""

    def __init__(self, metres: Floats, **db: Floats | float) -> None:
        self.metres = np.asarray(metres, np.float64)
        self._db = db

    def db(self, what: str) -> Floats:
        """Return dB [n] of `signal`, `first`, `hiss` or `count`: 0 of what is left alone."""
        return np.zeros(len(self.metres)) + self._db.get(what, 0.0)


def turned(places_m: Floats, ride: NDArray[np.intp], angle: Floats) -> Floats:
    """Return where places [n, 3] on rides [n] are when these have turned by angles in radians [n].

    Rodrigues's formula.
    """
    arm, axle = places_m - HUBS_M[ride], AXLES[ride]
    along = np.sum(arm * axle, axis=1, keepdims=True) * axle
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return np.asarray(HUBS_M[ride] + along + cos * (arm - along) + sin * np.cross(axle, arm))


class Ticket:
    """Rows of a table; `evening` seeds what all tables of a case share, `rng` all else."""

    def __init__(
        self, table: pd.DataFrame, evening: int, rng: np.random.Generator, hardly: bool = False
    ) -> None:
        self.table, self.evening, self.rng, self.hardly = table, evening, rng, hardly
        self.way: Floats = self("true_range_m")
        self.booth = np.array([int(name[len("booth") :]) for name in table["rx"]], np.intp)
        self.gondola = np.array([int(name[len("gondola") :]) for name in table["tx"]], np.intp)
        self._of_link, self._links = pd.factorize(table["link"])

    def __call__(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.array(self.table[name].to_numpy(np.float64))

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.evening, what, 982])

    def by_link(self, make: Callable[..., NDArray[np.floating]], *values: float) -> Floats:
        """Return one value for each link from a distribution of such values, at each row [n]."""
        return np.asarray(make(*values, size=len(self._links)), np.float64)[self._of_link]

    def chance(self, share: float) -> Floats:
        """Return 1 for such a share of the links, at all of their rows, else 0 [n]."""
        return np.asarray(self.by_link(self.rng.uniform, 0.0, 1.0) < share, np.float64)

    def roofs(self) -> Floats:
        """Return where booths have their antennas, as is written down [n, 3], in m."""
        return BOOTHS_M[self.booth]

    def seats(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where tags are some time later, when rides have turned on [n, 3], in m."""
        here: Floats = np.column_stack([self(f"tx_{axis}_m") for axis in "xyz"])
        if not np.any(later_s):
            return here  # to the last bit
        return turned(here, self("ride").astype(np.intp), self("spin_rad_per_s") * later_s)

    def drifts(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.drifts_to(self.seats(later_s))

    def drifts_to(self, seats_m: Floats) -> Floats:
        """Return by how much ways from tags at [n, 3] are longer, in m [n]."""
        return np.asarray(np.sqrt(np.sum((seats_m - self.roofs()) ** 2, axis=1)) - self.way)

    def passes(self, kind: str) -> Floats:
        """Return 1 for rows with such a thing in the straight path, else 0 [n]."""
        return np.fromiter((kind in some for some in self.table["obstacles"]), np.float64)

    def one_before(self, name: str) -> Floats:
        """Return a column of the row before of the same link and copy [n], NaN of firsts."""
        copy = self.table.groupby(["link", "time_s"], sort=False).cumcount()
        before = self.table.groupby([self.table["link"], copy], sort=False)[name].shift()
        return before.to_numpy(np.float64)
