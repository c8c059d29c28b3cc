"""Effect 20: integer accumulator values and their offset."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.loops import compiled, parts, quantise_rows
from bench.physics.randomness import Draws
from bench.physics.units import Complexes


@dataclass(frozen=True)
class Quantisation(Effect):
    """Adds a constant offset to real and imaginary part, rounds both and clips to 16 bits.

    The offset has a random direction per receiving device and a length of `offset_counts`
    (30 to 150 recorded). A step of zero neither rounds nor clips.
    """

    name = "quantisation"
    number = 20
    stage = "receiver"
    source = "DW1000 User Manual 2.11, 7.2.38 (ACC_MEM); offsets measured on zenodo.4742391"
    signature = "whole numbers; a constant added to every complex sample"
    needs = (("cir",),)
    without_cir = False

    step_counts: float = parameter(1, "counts", 0, 256, "rounding step", null=0)
    offset_counts: float = parameter(0, "counts", 0, 1000, "length of the offset", null=0)
    limit_counts: float = parameter(32767, "counts", 127, 32767, "largest value")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Round the noise, and its sum with the signal: both stay whole numbers."""
        if batch.waveform is None or batch.noise is None:
            return batch
        if self.step_counts == 0 and self.offset_counts == 0:
            return batch
        waveform, added = batch.waveform, batch.noise + self._offset(batch, draws)[:, None]
        if batch.as_given:  # else the samples tell
            batch = batch.steadier(np.full(len(batch), float(self.offset_counts) ** 2))
        if self.step_counts == 0:
            return replace(batch, noise=added)
        signal, noise = np.empty_like(waveform), np.empty_like(added)
        limits = np.float32(self.step_counts), np.float32(self.limit_counts)
        arrays = (parts(each) for each in (signal, noise, waveform, added))
        compiled(quantise_rows)(*arrays, *limits)
        return replace(batch, waveform=signal, noise=noise)

    def _offset(self, batch: Batch, draws: Draws) -> Complexes:
        angle = 2 * np.pi * draws.group_uniform(batch.rows.group("rx"))
        return np.asarray(self.offset_counts * np.exp(1j * angle), np.complex64)
