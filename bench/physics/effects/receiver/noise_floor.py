"""Effect 17: the level and the colour of the accumulator's noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.filters import coloured
from bench.physics.randomness import Draws
from bench.physics.units import Complexes, Floats, amplitude, scaled

NOISE_TOLD_BY = (
    "record the accumulator while no tag sends: its complex samples have a line in their spectrum "
    "where a tone is, and none where noise is"
)


@dataclass(frozen=True)
class NoiseFloor(Effect):
    """Scales the base's noise, colours it, and lets its level differ between devices.

    The complex autocorrelation of recorded noise is 0.32, -0.17, -0.20 at lags 1, 2, 3.
    """

    name = "noise-floor"
    number = 17
    stage = "receiver"
    stackable = True
    source = "measured on Zenodo 10.5281/zenodo.4742391"
    by_device = True
    told_by = NOISE_TOLD_BY
    logged_as = "noise_std"
    adds = "level_db"
    signature = "noise level and correlation in every bin alike, before the first path too"

    level_db: float = parameter(0, "dB", -20, 30, "over the base's noise", null=0)
    device_spread_db: float = parameter(
        0, "dB", 0, 6, "std over receiving devices", null=0, fitted=False
    )
    lag_1: float = parameter(0.32, "1", -0.45, 0.45, "autocorrelation at lag 1", null=0)
    lag_2: float = parameter(-0.17, "1", -0.3, 0.3, "autocorrelation at lag 2", null=0)
    lag_3: float = parameter(-0.20, "1", -0.25, 0.25, "autocorrelation at lag 3", null=0)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Scale and filter the noise of every row."""
        if batch.noise_power is None:
            return batch
        ratio = amplitude(self.level_db + self._spread(batch, draws))
        if batch.as_given:  # a table's own noise cannot be taken away: neither from its samples
            ratio = np.maximum(ratio, 1.0)  # nor from what is reported of them
        made = altered(batch, noise_power=batch.noise_power * ratio**2)
        if batch.noise is None:
            return made
        if batch.as_given:
            return altered(made, noise=batch.noise + self._missing(batch, ratio, draws))
        noise = self._coloured(batch.noise)
        return altered(made, noise=scaled(noise, ratio.astype(np.float32), noise))

    def _spread(self, batch: Batch, draws: Draws) -> Floats:
        """Return how much louder each row's device is than others [n] in dB."""
        if self.device_spread_db == 0:
            return np.zeros(len(batch))
        return self.device_spread_db * draws.group_normal(batch.rows.group("rx"))

    def _missing(self, batch: Batch, ratio: Floats, draws: Draws) -> Complexes:
        """Return the noise that a table's own, of known power, lacks; it cannot be taken away."""
        assert batch.noise is not None
        assert batch.noise_power is not None
        size = np.sqrt(batch.noise_power * np.maximum(ratio**2 - 1, 0)).astype(np.float32)
        return self._coloured(draws.complex_normal(*batch.noise.shape)) * size[:, None]

    def _coloured(self, noise: Complexes) -> Complexes:
        return coloured(noise, np.array([self.lag_1, self.lag_2, self.lag_3]))
