"""The pull and the fading of a reflection of the ground, for ranges without waveforms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from typing import ClassVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.effects.fitted.ridge import Ridge, without_fall
from bench.physics.effects.propagation.two_rays import (
    Rays,
    carriers_ghz,
    fades_db,
    fading_db,
    moves_m,
    pulled_m,
    rays,
)
from bench.physics.randomness import Draws
from bench.physics.scene import scene
from bench.physics.units import Floats

GRID: Floats = np.linspace(0.0, 0.95, 20)
FINER: Floats = np.linspace(0.01, 0.95, 95)
REACHES_M = (0.35, 0.5, 0.7, 1.0, 1.5)
STEEPNESSES = (0.0, 0.5, 1.5)
LEAST_ROWS = 12
CONSTANT_M, CONSTANT_DB = 1.0, 1.0  # typical, of another cause
NO_CONSTANT_DB = 1e-3  # too small to take anything


@dataclass(frozen=True)
class GroundRay(Effect):
    """Two rays at the heights of the row: the leading edge is pulled, and the level fades.

    The reflection has `size` at grazing incidence, less by (1 - sine)^`steepness` where it is
    steeper, and overlaps the edge while it is less than about `reach_m` longer. `level_size` is the
    same for the level, which a pulse blurs otherwise. Below zero: it is not turned around, as of
    upright antennas above Brewster's angle. What a receiver of another kind makes of both rays is
    beside that: factors `moved` of `moves_m`, and `louder` of `fades_db`; () for none.
    """

    name = "ground-ray"
    explains: ClassVar[str] = "ground-bounce"
    values_unit: ClassVar[str] = "1"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "two-ray model: group delay and sum of two phasors; fitted to recordings"
    signature = "ripple of power and a small signed bias over distance; excess falls as 1/d"
    needs = (("tx_z_m", "rx_z_m"),)

    size: float = parameter(0.0, "1", -1, 1, "of the reflection", null=0)
    level_size: float = parameter(0.0, "1", -1, 1, "of the reflection, in levels", null=0)
    carrier_ghz: float = parameter(6.4896, "GHz", 1, 12, "carrier")
    reach_m: float = parameter(0.7, "m", 0.05, 5, "excess within a pulse")
    steepness: float = parameter(0.0, "1", 0, 3, "how much weaker where it is steep")
    moved: tuple[float, ...] = ()
    louder: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tuples(self, moved=None, louder=None)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Pull ranges and change levels where heights are known."""
        found = rays(batch.rows)
        if found is None:
            return batch
        batch = batch.longer(self._moved(found))
        return batch.reported_louder(self._faded(found))

    def _pulled(self, found: Rays) -> Floats:
        ray = found.ray(self.carrier_ghz, self.size, self.steepness)
        return pulled_m(found.longer_m, ray, self.reach_m)

    def _moved(self, found: Rays) -> Floats:
        """Return by how much ranges are longer [n]."""
        pulled = self._pulled(found)
        return pulled + moves_m(found, self.carrier_ghz) @ self.moved if self.moved else pulled

    def _faded(self, found: Rays) -> Floats:
        """Return by how much levels are stronger [n], in dB."""
        gain = fading_db(found.ray(self.carrier_ghz, self.level_size, self.steepness))
        return gain + fades_db(found, self.carrier_ghz) @ self.louder if self.louder else gain

    def values(self) -> dict[str, float]:
        """Return the size of the reflection."""
        return {"size": self.size}

    @classmethod
    def fit_values(cls, frame: pd.DataFrame, residual_m: NDArray[np.float64]) -> Effect | None:
        """Return the reflection that leaves least of residual ranges, None where none helps."""
        rows = scene(frame, "recorded")
        found, known = rays(rows), np.isfinite(residual_m)
        if found is None or known.sum() < LEAST_ROWS:
            return None
        own = Rays(found.longer_m[known], found.size[known], found.flat[known])
        left = residual_m[known]
        made = [cls._of_carrier(one, own, left) for one in carriers_ghz(rows)]
        best = min(made, key=lambda one: _missed(left, one._moved(own)))
        return best if _missed(left, best._moved(own)) < _missed(left, np.zeros(1)) else None

    @classmethod
    def _of_carrier(cls, carrier_ghz: float, own: Rays, left: Floats) -> GroundRay:
        """Return the reflection of one carrier that leaves least, with what it moves besides."""
        tried = [
            cls(carrier_ghz=carrier_ghz, reach_m=reach, steepness=steepness, size=float(size))
            for reach, steepness in product(REACHES_M, STEEPNESSES)
            for size in (*GRID[1::3], *-GRID[1::3])
        ]
        best = min(tried, key=lambda one: _missed(left, one._pulled(own)))
        finer = [replace(best, size=float(size)) for size in FINER * np.sign(best.size)]
        best = min(finer, key=lambda one: _missed(left, one._pulled(own)))
        more = Ridge(moves_m(own, carrier_ghz), left - best._pulled(own), CONSTANT_M)
        return replace(best, moved=tuple(more.factors.tolist()))

    def with_level(self, frame: pd.DataFrame, left_db: Floats) -> GroundRay:
        """Return it with the size that leaves least of residual levels [n], and what is beside.

        A fall of levels with the distance is a path loss rather than what a receiver makes of two
        rays, where levels bear it out. So is a constant, but where levels are farther for it: then
        it is the mean of what goes up and down. Where that helps no more, levels stay as they are.
        """
        rows, known = scene(frame, "recorded"), np.isfinite(left_db)
        found = rays(rows)
        if found is None or not known.any():
            return self
        left, far = left_db[known], rows.true_range_m[known]
        if known.sum() < LEAST_ROWS:
            return self._sized(found, known, left)
        ways = fades_db(found, self.carrier_ghz)[known]
        left = without_fall(ways, left, far, _repeats(frame), CONSTANT_DB)
        for constant_db in (CONSTANT_DB, NO_CONSTANT_DB):
            made = self._heard(found, known, left, constant_db)
            if np.abs(left - made._faded(found)[known]).mean() < np.abs(left).mean():
                return made
        return replace(self, level_size=0.0, louder=())

    def _heard(
        self, found: Rays, known: NDArray[np.bool_], left_db: Floats, constant_db: float
    ) -> GroundRay:
        """Return it with what levels [k] of known rows show of it, beside a constant of a size."""
        best = self._sized(found, known, left_db)
        ways = fades_db(found, self.carrier_ghz)[known]
        more = Ridge(ways, left_db - best._faded(found)[known], constant_db)
        return replace(best, louder=tuple(more.factors.tolist()))

    def _sized(self, found: Rays, known: NDArray[np.bool_], left_db: Floats) -> GroundRay:
        """Return it with the size that leaves least of residual levels [k] of known rows."""
        bare = replace(self, louder=())
        sizes = [replace(bare, level_size=float(size)) for size in (*GRID, *-GRID[1:])]
        return min(sizes, key=lambda one: _missed(left_db, one._faded(found)[known]))


def _repeats(frame: pd.DataFrame) -> float:
    """Return as how many one row counts: rows of a link are near-copies."""
    return frame["link"].nunique() / len(frame) if "link" in frame else 1.0


def _missed(left: Floats, made: Floats) -> float:
    """Return how much is left around its median, in the mean: a constant is another cause."""
    rest = left - made
    return float(np.mean(np.abs(rest - np.median(rest))))
