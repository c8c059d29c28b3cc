"""Effect 20: integer accumulator values and their offset."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.physics.base import there
from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.loops import compiled, parts, quantise_rows
from bench.physics.randomness import Draws
from bench.physics.units import Complexes, Floats

_QUANTILES = (np.arange(256) + 0.5) / 256  # of a noise whose rounding is worked out


@dataclass(frozen=True)
class Quantisation(Effect):
    """Adds a constant offset to real and imaginary part, rounds both and clips.

    The offset has a random direction per receiving device and a length of `offset_counts`
    (30 to 150 recorded). A step of zero neither rounds nor clips; as delivered only what 24 bits
    do not hold is clipped: a simulator whose counts have another scale is not to be cut. Low bits
    that are dropped round towards zero (`dropped` 1); dropped where samples are read out
    (`read_out` 1), they leave the noise as the receiver reports it.
    """

    name = "quantisation"
    number = 20
    stage = "receiver"
    source = "DW1000 User Manual 2.11, 7.2.38 (ACC_MEM); offsets measured on zenodo.4742391"
    signature = "whole numbers; a constant added to every complex sample"
    needs = (("cir",),)
    without_cir = False
    essential = ("step_counts",)

    step_counts: float = parameter(1, "counts", 0, 256, "rounding step", null=0)
    offset_counts: float = parameter(0, "counts", 0, 1000, "length of the offset", null=0)
    limit_counts: float = parameter(
        8388607, "counts", 127, 8388607, "largest value: 32767 of 16 bits", fitted=False
    )
    dropped: float = parameter(0, "1", 0, 1, "0 rounds to the nearest step, 1 towards zero")
    read_out: float = parameter(0, "1", 0, 1, "0 in the accumulator, 1 where it is read out")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Round the noise, and its sum with the signal: both stay whole numbers."""
        if batch.waveform is None or batch.noise is None:
            return batch
        if self.step_counts == 0 and self.offset_counts == 0:
            return batch
        waveform, added = batch.waveform, batch.noise + self._offset(batch, draws)[:, None]
        if batch.as_given:  # else the samples tell
            batch = self._as_reported(batch)
        if self.step_counts == 0:
            return replace(batch, noise=added)
        signal, noise = np.empty_like(waveform), np.empty_like(added)
        settings = (np.float32(v) for v in (self.step_counts, self.limit_counts, self.dropped))
        arrays = (parts(each) for each in (signal, noise, waveform, added))
        compiled(quantise_rows)(*arrays, *settings)
        unseen = np.complex64(self.read_out) * (added - noise)
        return replace(batch, waveform=signal - unseen, noise=noise + unseen)

    def _offset(self, batch: Batch, draws: Draws) -> Complexes:
        angle = 2 * np.pi * draws.group_uniform(batch.rows.group("rx"))
        return np.asarray(self.offset_counts * np.exp(1j * angle), np.complex64)

    def _as_reported(self, batch: Batch) -> Batch:
        """Return a batch of given samples with the noise that is reported of them rounded."""
        ratio = 1 + (1 - self.read_out) * (self._rounded_noise(there(batch.noise_power)) - 1)
        batch = replace(batch, noise_power=there(batch.noise_power) * ratio**2)
        return batch.steadier(np.full(len(batch), float(self.offset_counts) ** 2))

    def _rounded_noise(self, power: Floats) -> Floats:
        """Return by what factor [n] rounding changes the scatter of noise magnitudes."""
        if self.step_counts == 0:
            return np.ones(len(power))
        size = np.sqrt(np.maximum(power, 1e-12))[:, None] * np.sqrt(-np.log(1 - _QUANTILES))
        steps = np.floor(size / self.step_counts + 0.5 - 0.5 * self.dropped)
        return np.asarray(steps.std(axis=1) * self.step_counts / size.std(axis=1))
