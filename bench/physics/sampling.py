"""From paths and tail to the accumulator's samples."""

from __future__ import annotations

import numpy as np

from bench.physics.batch import NO_PATH, Batch
from bench.physics.loops import add_paths, add_tail, compiled, parts
from bench.physics.pulse import HALF_WIDTH, STEPS, table
from bench.physics.units import Complexes, Reals

_FARTHEST = np.float32(1e6)  # samples
_LINEAR = np.linspace(0, 1, STEPS + 1, dtype=np.float32)[:, None]


def sampled(batch: Batch, start_ns: Reals, samples: int, fwhm_samples: float) -> Complexes:
    """Return the noise-free waveform [n, samples] in sqrt(mW), sample 0 at `start_ns` [n].

    Delays are resolved to 1/64 sample (2.3 mm of one-way path); what lies outside the window is
    lost. A path of power P gives samples of energy P.
    """
    made = np.zeros((len(batch), 2 * samples), np.float32)
    gain = np.where(batch.kind == NO_PATH, np.complex64(0), batch.gain)
    period = np.float32(batch.sample_period_ns)
    place = _within_reach((batch.excess_ns - start_ns[:, None]) / period)
    compiled(add_paths)(made, place, parts(gain), table(fwhm_samples))
    if batch.tail.shape[1]:
        pulse, reach = _tail_pulse(batch, fwhm_samples)
        first = _within_reach((batch.tail_start_ns - start_ns) / period - np.float32(reach))
        compiled(add_tail)(made, first, parts(batch.tail), pulse)
    return made.view(np.complex64)


def _within_reach(place: Reals) -> Reals:
    """Return places in samples that a loop can count to; what is no number lies far outside."""
    return np.asarray(np.fmin(np.fmax(place, -_FARTHEST), _FARTHEST), np.float32)


def _tail_pulse(batch: Batch, fwhm_samples: float) -> tuple[Reals, int]:
    """Return what each tap becomes, by alignment, and how many samples it begins before the tap.

    A bare tap becomes a pulse; one of a CIR as given is only interpolated.
    """
    if batch.tail_fwhm:
        return np.concatenate([1 - _LINEAR, _LINEAR], axis=1), 0
    return table(fwhm_samples), HALF_WIDTH
