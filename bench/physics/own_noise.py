"""The noise of another simulator's CIRs where signals grow stronger or weaker.

A table's samples hold signal and noise. What makes the signal weaker on its way leaves the noise
of the receiver as it is, so samples are scaled by how much of them is signal (Wiener 1949).
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d

from bench.physics.units import Complexes, Floats, Reals, absolute

WINDOW = 5  # samples over which power is averaged: about a pulse


def with_own_noise(waveform: Complexes, gain: Floats, noise_power: Floats) -> Complexes:
    """Return waveforms [n, S] with the noise they had before `gain` [n] scaled it along.

    `noise_power` [n] is the mean |noise|^2 of a sample before; rows of gain one stay as they are.
    """
    scaled = np.flatnonzero(np.isfinite(gain) & (np.abs(gain - 1) > 1e-4))
    if not len(scaled):
        return waveform
    out = waveform.copy()
    factor = _factor(absolute(waveform[scaled]), gain[scaled] ** 2, noise_power[scaled])
    out[scaled] *= factor.astype(np.float32)
    return out


def _factor(size: Reals, ratio: Floats, noise_power: Floats) -> Floats:
    """Return what gives samples of magnitude `size` [n, S] the noise again, by power ratio [n]."""
    power = uniform_filter1d(size.astype(np.float64) ** 2, WINDOW, axis=1, mode="nearest")
    scaled = (ratio * noise_power)[:, None]
    signal = np.maximum(power - scaled, 0)
    whole = signal + scaled
    return np.asarray(np.sqrt((signal + noise_power[:, None]) / np.maximum(whole, 1e-12)))
