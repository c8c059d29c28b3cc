"""Effect 4: temperature moves the range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats
from bench.physics.ways import known_mostly

TYPICAL_M, REFERENCE_C, SPAN_C = 0.05, 25.0, 20.0  # 2.15 mm per degree, at 20 degrees
FARTHEST_C = 40.0  # from the temperature of the calibration
WARM_UP_S = (200.0, 600.0, 1800.0, 5400.0)
RELAXING_S = tuple(float(s) for s in np.geomspace(5, 20_000, 40))


@dataclass(frozen=True)
class TemperatureDrift(Effect):
    """Ranges grow by 2.15 mm per degree, and while the devices warm up.

    Degrees over `reference_c` come from `temperature_c`, 25 where that is not known. `warm_up_c` x
    (1 - exp(-time / `warm_up_s`)) is added from `time_s`, for warming that is not recorded: what
    was calibrated warm, its reference above, is off until it is.
    """

    name = "temperature-drift"
    number = 4
    stage = "ranging"
    stackable = True
    source = "DW1000 User Manual 2.11, section 8.3 on calibration (2.15 mm per degree Celsius)"
    signature = "slow; exponential in time after switching on, the same at all distances"
    everywhere = True
    needs = (("temperature_c",), ("time_s",))
    control = "rows at the reference temperature at time zero"

    slope_mm_per_c: float = parameter(2.15, "mm/degC", -20, 20, "per degree", null=0)
    reference_c: float = parameter(25, "degC", -40, 85, "where the calibration was made")
    warm_up_c: float = parameter(0, "degC", 0, 60, "rise after switching on", null=0)
    warm_up_s: float = parameter(600, "s", 1, 36000, "time constant of the rise")

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return a cubic over temperature, as crystals have it; relaxations over time without.

        Crystals of AT and SC cuts follow a cubic of the temperature (arXiv 1804.07432).
        """
        warm = known_mostly(rows.number("temperature_c", np.nan))
        time_s = known_mostly(rows.number("time_s", np.nan))
        if warm is not None:
            warm = (warm - REFERENCE_C) / SPAN_C
            parts = [np.ones(len(rows)), warm, warm**2, warm**3]
        elif time_s is not None:
            parts = [np.exp(-np.maximum(time_s, 0) / tau) for tau in (*WARM_UP_S, np.inf)]
        else:
            return None
        return (TYPICAL_M * np.stack(parts, axis=1),)

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:
        """Return whether it varies with the temperature, not only by a constant."""
        warm = known_mostly(rows.number("temperature_c", np.nan))
        if warm is None:
            return True
        per_degree = float(np.std(shift_m) / np.std(warm))
        return abs(float(np.mean(shift_m))) < FARTHEST_C * per_degree

    @classmethod
    def like(cls, rows: Scene, shift_m: NDArray[np.float64]) -> dict[str, float]:
        """Return the slope and the reference of a line over the temperature, where it is known.

        Both together: where it is cold, no slope about the default reference does any good. Without
        a temperature those of the likeliest warming.
        """
        warm = known_mostly(rows.number("temperature_c", np.nan))
        time_s = known_mostly(rows.number("time_s", np.nan))
        over = time_s if warm is None else warm
        if over is None or not np.ptp(over) or not np.ptp(shift_m):
            return {}
        line = _warming(over, shift_m) if warm is None else _line(over, shift_m)
        known = {item.name: item for item in cls.parameters()}
        return {o: float(np.clip(v, known[o].low, known[o].high)) for o, v in line.items()}

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by slope x degrees over the reference."""
        return batch.longer(self.longer_m(batch.rows))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows at the reference temperature and time zero."""
        return np.asarray(self._warmer(batch.rows) == 0)

    def longer_m(self, rows: Scene) -> Floats:
        """Return by how much ranges of rows are longer [n], in metres."""
        return self.slope_mm_per_c / 1000 * self._warmer(rows)

    def _warmer(self, rows: Scene) -> Floats:
        """Return the degrees over the reference [n]."""
        time_s = np.maximum(rows.number("time_s", 0.0), 0)
        rise = self.warm_up_c * (1 - np.exp(-time_s / self.warm_up_s))
        known = rows.number("temperature_c", REFERENCE_C)
        return np.asarray(known - self.reference_c + rise)


def _line(warm_c: Floats, shift_m: Floats) -> dict[str, float]:
    """Return the slope and the reference of ranges [n] that follow a temperature [n]."""
    slope, mean_m = np.polyfit(warm_c - warm_c.mean(), shift_m, 1)
    return {"slope_mm_per_c": 1000 * slope, "reference_c": warm_c.mean() - mean_m / slope}


def _warming(time_s: Floats, shift_m: Floats) -> dict[str, float]:
    """Return the parameters of ranges [n] that relax over time [n], by `SPAN_C` degrees."""

    def relaxing(tau_s: float) -> tuple[float, Floats]:
        parts = np.stack([np.ones(len(time_s)), np.exp(-np.maximum(time_s, 0) / tau_s)], axis=1)
        made = np.linalg.lstsq(parts, shift_m, rcond=None)[0]
        return float(np.sum((shift_m - parts @ made) ** 2)), made

    tau_s = min(RELAXING_S, key=lambda one: relaxing(one)[0])
    warm_m, cold_m = relaxing(tau_s)[1]
    slope = -cold_m / SPAN_C or 1e-9
    return {
        "slope_mm_per_c": 1000 * slope,
        "reference_c": REFERENCE_C + SPAN_C - warm_m / slope,
        "warm_up_c": SPAN_C,
        "warm_up_s": tau_s,
    }
