"""From paths and tail to the accumulator's samples."""

from __future__ import annotations

import numpy as np

from bench.physics.batch import NO_PATH, Batch
from bench.physics.pulse import HALF_WIDTH, STEPS, table
from bench.physics.units import Complexes, Reals


def sampled(batch: Batch, start_ns: Reals, samples: int, fwhm_samples: float) -> Complexes:
    """Return the noise-free waveform [n, samples] in sqrt(mW), sample 0 at `start_ns` [n].

    Paths outside the window are lost. A path of power P gives samples of energy P.
    """
    waveform = _paths(batch, start_ns, samples, fwhm_samples)
    if batch.tail.shape[1]:
        waveform += _tail(batch, start_ns, samples, fwhm_samples)
    return waveform


def _paths(batch: Batch, start_ns: Reals, samples: int, fwhm_samples: float) -> Complexes:
    """Add each path's pulse at its delay, to 1/64 sample (2.3 mm of one-way path)."""
    row, path = np.nonzero(batch.kind != NO_PATH)
    place = (batch.excess_ns[row, path] - start_ns[row]) / batch.sample_period_ns
    inside = (place > HALF_WIDTH) & (place < samples - HALF_WIDTH - 2)
    row, path, place = row[inside], path[inside], place[inside]
    whole = np.floor(place).astype(np.intp)
    step = np.rint((place - whole) * STEPS).astype(np.intp)
    pulses = table(fwhm_samples)[step]
    first = row * samples + whole - HALF_WIDTH
    index = (first[:, None] + np.arange(pulses.shape[1])).ravel()
    gain = batch.gain[row, path]
    size = len(batch) * samples
    real = np.bincount(index, (gain.real[:, None] * pulses).ravel(), size)
    imag = np.bincount(index, (gain.imag[:, None] * pulses).ravel(), size)
    return (real + 1j * imag).astype(np.complex64).reshape(len(batch), samples)


def _tail(batch: Batch, start_ns: Reals, samples: int, fwhm_samples: float) -> Complexes:
    """Convolve the tail's taps with the pulse, each row at its own sub-sample alignment."""
    place = (batch.tail_start_ns - start_ns) / batch.sample_period_ns
    whole = np.floor(place).astype(np.intp)
    fraction = place - whole
    if batch.tail_fwhm:
        weights, reach = np.stack([1 - fraction, fraction], axis=1).astype(np.float32), 0
    else:
        weights = table(fwhm_samples)[np.rint(fraction * STEPS).astype(np.intp)]
        reach = HALF_WIDTH
    width = weights.shape[1]
    taps = _aligned(batch.tail, whole - reach, samples, width).view(np.float32)
    made = np.zeros((len(batch), 2 * samples), np.float32)
    part = np.empty_like(made)
    for lag in range(width):  # on real and imaginary parts side by side: no complex products
        start = 2 * (width - 1 - lag)
        made += np.multiply(weights[:, lag, None], taps[:, start : start + 2 * samples], out=part)
    return made.view(np.complex64)


def _aligned(tail: Complexes, first: np.ndarray, samples: int, width: int) -> Complexes:
    """Return taps [n, samples + width - 1] such that column `width - 1 + k` is tap k - first."""
    columns = np.arange(-(width - 1), samples)
    if np.all(first == first[0]):  # the usual case: one slice for all rows
        wanted = columns - first[0]
        taps = np.zeros((len(tail), len(columns)), np.complex64)
        inside = (wanted >= 0) & (wanted < tail.shape[1])
        taps[:, inside] = tail[:, wanted[inside]]
        return taps
    wanted = columns[None, :] - first[:, None]
    inside = (wanted >= 0) & (wanted < tail.shape[1])
    picked = np.take_along_axis(tail, np.clip(wanted, 0, tail.shape[1] - 1), axis=1)
    return np.where(inside, picked, np.complex64(0))
