"""The noise of another simulator's CIRs where signals grow stronger or weaker.

A table's samples hold signal and noise. What makes the signal weaker on its way leaves the noise
of the receiver as it is: as much as was scaled away is added. Where the signal grows, samples are
scaled by how much of them is signal (Wiener 1949).
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d

from bench.physics.units import Complexes, Floats, Reals, absolute

WINDOW = 5  # samples over which power is averaged: about a pulse


def with_own_noise(
    waveform: Complexes, gain: Floats, noise_power: Floats, drawn: Complexes
) -> Complexes:
    """Return waveforms [n, S] with the noise they had before `gain` [n] scaled it along.

    `noise_power` [n] is the mean |noise|^2 of a sample before, `drawn` [n, S] noise of power one;
    rows of gain one stay as they are.
    """
    known = np.isfinite(gain) & (np.abs(gain - 1) > 1e-4)
    if not known.any():
        return waveform
    out, louder, weaker = waveform.copy(), known & (gain > 1), known & (gain < 1)
    factor = _factor(absolute(waveform[louder]), gain[louder] ** 2, noise_power[louder])
    out[louder] *= factor.astype(np.float32)
    away = np.sqrt((1 - gain[weaker] ** 2) * noise_power[weaker]).astype(np.float32)
    out[weaker] += drawn[weaker] * away[:, None]
    return out


def unit_noise(peaks: Floats, samples: int) -> Complexes:
    """Return complex noise of power one [n, samples], of rows whose highest samples are `peaks`.

    Other rows get other noise, the same rows always the same.
    """
    finite = np.nan_to_num(peaks)
    seed = np.frombuffer(np.ascontiguousarray(finite).tobytes(), np.uint32)
    parts = np.random.default_rng(seed).normal(size=(len(peaks), samples, 2)) / np.sqrt(2)
    return np.asarray(parts[..., 0] + 1j * parts[..., 1], np.complex64)


def _factor(size: Reals, ratio: Floats, noise_power: Floats) -> Floats:
    """Return what gives samples of magnitude `size` [n, S] the noise again, by power ratio [n]."""
    power = uniform_filter1d(size.astype(np.float64) ** 2, WINDOW, axis=1, mode="nearest")
    scaled = (ratio * noise_power)[:, None]
    signal = np.maximum(power - scaled, 0)
    whole = signal + scaled
    return np.asarray(np.sqrt((signal + noise_power[:, None]) / np.maximum(whole, 1e-12)))
