"""Acting on taps that already hold the pulse: a recorded or foreign CIR instead of paths."""

from __future__ import annotations

import numpy as np

from bench.physics.filters import convolved, lagrange
from bench.physics.pulse import HALF_WIDTH, table
from bench.physics.units import Complexes, Floats, Reals


def first_edge(taps: Complexes, peak_at: Floats, fwhm_samples: float) -> Complexes:
    """Return the part of `taps` [n, G] that belongs to the first path, peaking at `peak_at` [n].

    Everything up to half a pulse behind the peak, then fading out over half a pulse more.
    """
    behind = (np.arange(taps.shape[1]) - peak_at[:, None]) / fwhm_samples
    weight = np.clip(2 - 2 * behind, 0, 1).astype(np.float32)
    return taps * (weight * weight * (3 - 2 * weight))


def shifted(taps: Complexes, by_samples: Floats) -> Complexes:
    """Return `taps` [n, G] later by a number of samples per row [n], cubic between taps.

    Linear interpolation would widen the pulse and so move its edge by up to 4 cm.
    """
    whole = np.floor(by_samples).astype(np.intp)
    weights = lagrange(np.asarray(by_samples - whole))
    column = np.arange(taps.shape[1]) - whole[:, None]
    made = np.zeros_like(taps)
    for lag, weight in zip((-1, 0, 1, 2), weights, strict=True):
        made += _at(taps, column - lag) * weight[:, None]
    return made


def with_pulse(taps: Complexes, fwhm_samples: float) -> Complexes:
    """Return bare taps with the pulse put on each of them."""
    pulse: Reals = table(fwhm_samples)[0, : 2 * HALF_WIDTH + 1]
    return convolved(taps, pulse.astype(np.float64))


def _at(taps: Complexes, column: np.ndarray) -> Complexes:
    """Return the taps at `column` [n, G], zero outside."""
    inside = (column >= 0) & (column < taps.shape[1])
    picked = np.take_along_axis(taps, np.clip(column, 0, taps.shape[1] - 1), axis=1)
    return np.where(inside, picked, np.complex64(0))
