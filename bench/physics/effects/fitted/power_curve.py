"""Bias over the received power as a curve, for powers that the library's shape does not follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats

# DW1000 at 64 MHz PRF: logged receive level and the true one it stands for (APS011, figure 5).
LOGGED_DBM = (-120.0, -90.0, -87.5, -85.0, -82.5, -80.0, -77.5)
TRUE_DBM = (-120.0, -90.0, -86.5, -83.5, -80.0, -72.5, -60.0)
_GRID_DBM = np.arange(-115.0, -40.0, 0.5)
LOGGED_STD_DB = 0.4  # scatter of the logged level


def logged_at(true_dbm: Floats | float, compression: float = 1.0) -> Floats:
    """Return the level that is logged where `true_dbm` arrives: 0 `compression` logs what does."""
    compressed = np.interp(true_dbm, TRUE_DBM, LOGGED_DBM)
    return np.asarray(true_dbm + compression * (compressed - true_dbm))


def at_level(level_dbm: float, compression: float = 1.0) -> str:
    """Return the name of the bias at a true receive level, with the level that is logged there."""
    logged = float(logged_at(level_dbm, compression))
    also = "" if round(logged, 1) == round(level_dbm, 1) else f", logged {logged:.1f}"
    return f"bias_m[{level_dbm:g} dBm{also}]"


def true_level_dbm(
    logged: Floats, budget: Floats, spread_db: float, compression: float = 1.0
) -> Floats:
    """Return the expected true receive level [n] in dBm.

    Combines the `logged` level, which compresses above -80 dBm, with the link `budget` level
    known to `spread_db` (posterior mean over a grid); where none was logged, the budget's.
    """
    misfit = ((logged[:, None] - logged_at(_GRID_DBM, compression)) / LOGGED_STD_DB) ** 2
    weight = np.nan_to_num(misfit) + ((_GRID_DBM - budget[:, None]) / spread_db) ** 2
    weight = np.exp((weight.min(axis=1, keepdims=True) - weight) / 2)
    return np.asarray((weight * _GRID_DBM).sum(axis=1) / weight.sum(axis=1))


@dataclass(frozen=True)
class PowerCurve(Effect):
    """Received-power-dependent bias as a curve: `bias_m` at the true receive `levels_dbm`.

    The level of a row comes from its logged `rx_power_dbm` (decompressed) and a free-space budget
    of `level_at_1m_dbm`, known to `spread_db`. Rows without a logged level use the simulated one.
    """

    name = "power-curve"
    explains: ClassVar[str] = "power-bias"
    contains = ("antenna-delay",)  # a curve that is level
    values_unit: ClassVar[str] = "m"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "Decawave application note APS011, version 1.0; curve fitted to recordings"
    signature = (
        "an S-curve of error over receive level at fixed distance, in line of sight too; levels "
        "are those at the antenna, of which a receiver logs the stronger too low (figure 5 there)"
    )
    follows = "rx_power_dbm"
    needs = (("rx_power_dbm",),)

    levels_dbm: tuple[float, ...] = (-77.0,)
    bias_m: tuple[float, ...] = (0.0,)
    level_at_1m_dbm: float = parameter(-58, "dBm", -80, -30, "budget at 1 m")
    spread_db: float = parameter(3, "dB", 0.2, 15, "how well the budget is known")
    compression: float = parameter(1, "1", 0, 1, "of logged levels: 1 a DW1000's, 0 none")

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tuples(self, levels_dbm=None, bias_m=len(self.levels_dbm))

    def level_dbm(self, rows: Scene) -> Floats:
        """Return the true receive level of each row [n]."""
        logged = rows.numbers.get("rx_power_dbm", np.full(len(rows), np.nan))
        budget = self.level_at_1m_dbm - 20 * np.log10(rows.true_range_m)
        logged = np.asarray(logged, np.float64)
        return true_level_dbm(logged, budget, self.spread_db, self.compression)

    def values(self) -> dict[str, float]:
        """Return the bias at every level in metres."""
        pairs = zip(self.levels_dbm, self.bias_m, strict=True)
        return {at_level(level, self.compression): bias for level, bias in pairs}

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the curve at each row's level."""
        level = self.level_dbm(batch.rows) if batch.rows.has("rx_power_dbm") else batch.level()
        return batch.longer(np.interp(level, self.levels_dbm, self.bias_m))
