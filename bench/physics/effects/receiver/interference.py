"""Effect 19: a narrowband interferer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.effects.receiver.noise_floor import NOISE_TOLD_BY
from bench.physics.randomness import Draws
from bench.physics.units import Floats, Reals, amplitude


@dataclass(frozen=True)
class NarrowbandInterference(Effect):
    """Adds a tone to the noise: ripple across all bins, those before the first path included.

    Its level is `level_db` over the noise, with a spread of `fading_db` from row to row (5.6 dB is
    that of a Rayleigh channel), its frequency lies `offset_mhz` beside the carrier, its phase is
    random; it is on in `share` of the rows. The noise that the DW1000 logs is its scatter, which a
    tone hardly raises; another tool's table may have its power (`power_logged`).
    """

    name = "narrowband-interference"
    number = 19
    stage = "receiver"
    stackable = True
    source = "a tone through the receiver's linear chain; level and offset are free parameters"
    signature = "ripple of one period over all bins; raises the noise, so late detection too"
    needs = (("cir",),)
    without_cir = False
    with_phases = True  # beside magnitudes taken as real it would beat with all noise alike
    told_by = NOISE_TOLD_BY
    essential_with_cir = ("share",)  # a tone in none of the rows
    of_phases = ("offset_mhz",)  # powers show only how it beats with noise, which receivers colour

    level_db: float = parameter(6, "dB", -20, 40, "median power over the noise's", null=-20)
    fading_db: float = parameter(5.6, "dB", 0, 12, "std of the level over rows")
    offset_mhz: float = parameter(80, "MHz", -250, 250, "from the carrier")
    share: float = parameter(1, "ratio", 0, 1, "of the rows", null=0)
    power_logged: float = parameter(
        0, "0 or 1", 0, 1, "whether a table's noise_std is of power, not of scatter", fitted=False
    )

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Add the tone to the noise of the struck rows."""
        if batch.noise is None or batch.noise_power is None or self.level_db <= -20:
            return batch
        level = self.level_db + self.fading_db * draws.normal(len(batch))
        size = np.sqrt(batch.noise_power) * amplitude(np.asarray(level, np.float64))
        size = np.where(self._struck(draws, len(batch)), size, 0)
        turns = self.offset_mhz * 1e-3 * batch.sample_period_ns * np.arange(batch.noise.shape[1])
        started = size * _turned(draws.uniform(len(batch), 1)[:, 0])
        tone = np.outer(started.astype(np.complex64), _turned(turns % 1).astype(np.complex64))
        noise = batch.noise + tone
        return altered(batch, noise=noise).steadier(size**2, not self.power_logged)

    def _struck(self, draws: Draws, rows: int) -> NDArray[np.bool_]:
        return np.asarray(draws.uniform(rows) < self.share)


def _turned(turns: Floats | Reals) -> NDArray[np.complex128]:
    """Return the unit phasor of an angle in turns."""
    return np.asarray(np.exp(2j * np.pi * np.asarray(turns, np.float64)))
