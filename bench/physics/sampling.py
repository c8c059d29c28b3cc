"""From paths and tail to the accumulator's samples."""

from __future__ import annotations

import numpy as np

from bench.physics.batch import NO_PATH, Batch
from bench.physics.loops import add_paths, add_tail, compiled, parts
from bench.physics.pulse import HALF_WIDTH, STEPS, table
from bench.physics.units import Complexes, Reals

_LINEAR = np.linspace(0, 1, STEPS + 1, dtype=np.float32)[:, None]


def sampled(batch: Batch, start_ns: Reals, samples: int, fwhm_samples: float) -> Complexes:
    """Return the noise-free waveform [n, samples] in sqrt(mW), sample 0 at `start_ns` [n].

    Delays are resolved to 1/64 sample (2.3 mm of one-way path); what lies outside the window is
    lost. A path of power P gives samples of energy P.
    """
    made = np.zeros((len(batch), 2 * samples), np.float32)
    gain = np.where(batch.kind == NO_PATH, np.complex64(0), batch.gain)
    place = (batch.excess_ns - start_ns[:, None]) / np.float32(batch.sample_period_ns)
    compiled(add_paths)(made, place, parts(gain), table(fwhm_samples))
    if batch.tail.shape[1]:
        first = (batch.tail_start_ns - start_ns) / np.float32(batch.sample_period_ns)
        pulse, reach = _tail_pulse(batch, fwhm_samples)
        compiled(add_tail)(made, first - np.float32(reach), parts(batch.tail), pulse)
    return made.view(np.complex64)


def _tail_pulse(batch: Batch, fwhm_samples: float) -> tuple[Reals, int]:
    """Return what each tap becomes, by alignment, and how many samples it begins before the tap.

    A bare tap becomes a pulse; one of a CIR as given is only interpolated.
    """
    if batch.tail_fwhm:
        return np.concatenate([1 - _LINEAR, _LINEAR], axis=1), 0
    return table(fwhm_samples), HALF_WIDTH
