"""Acting on taps that already hold the pulse: a recorded or foreign CIR instead of paths."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.ndimage import spline_filter1d

from bench.physics.filters import convolved
from bench.physics.pulse import HALF_WIDTH, table
from bench.physics.units import Complexes, Floats, Reals, absolute

NEAR_FWHM: Final = 0.5  # about the peak, where samples tell how high it is [convention]
REACH_FWHM: Final = 2.0  # behind which a pulse is over: -96 dB [derived]
LEAST: Final = 1e-30  # no signal [rounding]


def first_share(taps: Complexes, peak_at: Floats, fwhm_samples: float) -> Reals:
    """Return which share of all `taps` [n, G] belongs to a first path peaking at `peak_at` [n].

    Everything up to half a pulse behind the peak; from there on as much as a pulse of that width
    and height has, the rest is of later paths.
    """
    behind = (np.arange(taps.shape[1]) - peak_at[:, None]) / fwhm_samples
    pulse = np.exp(-4 * np.log(2) * np.minimum(behind**2, REACH_FWHM**2)).astype(np.float32)
    size = absolute(taps)
    near = np.where(np.abs(behind) < NEAR_FWHM, pulse, 0)
    height = (near * size).sum(axis=1) / np.maximum((near**2).sum(axis=1), LEAST)
    share = np.minimum(height[:, None] * pulse / np.maximum(size, LEAST), 1)
    share = np.where(behind < REACH_FWHM, share, 0)
    return np.where(behind <= 0.5, 1, share).astype(np.float32)


def smooth(place: Floats | Reals) -> Reals:
    """Return a step from 0 to 1 between places 0 and 1, without a corner."""
    inside = np.clip(place, 0, 1).astype(np.float32)
    return np.asarray(inside * inside * (3 - 2 * inside))


def noise_left(share: Reals, ratio: Reals, by_samples: Floats) -> Reals:
    """Return what is left of the noise of taps, in amplitude [n, G], where a first path is changed.

    `share` [n, G] of every tap becomes `ratio` [n, 1] of itself, later by `by_samples` [n]: noise
    of other samples then, which adds up by its power.
    """
    lost = 1 - share
    later = absolute(shifted(share.astype(np.complex64), np.rint(by_samples)))
    later = np.where(np.arange(share.shape[1]) < by_samples[:, None], 1, later)
    apart = np.sqrt(lost**2 + (ratio * later) ** 2)
    left = np.where(by_samples[:, None] < 1, lost + ratio * share, apart)
    return np.asarray(np.minimum(left, 1), np.float32)


def shifted(taps: Complexes, by_samples: Floats) -> Complexes:
    """Return `taps` [n, G] later by a number of samples per row [n], as a cubic spline between.

    A line or a cubic through the next taps would widen the pulse, and so move its edge (by 4 cm)
    and lower its top (Unser 1999).
    """
    whole = np.floor(by_samples).astype(np.intp)
    if not (by_samples - whole).any():
        return _at(taps, np.arange(taps.shape[1]) - whole[:, None])
    knots = spline_filter1d(taps, axis=1, output=taps.dtype, mode="mirror")
    column = np.arange(taps.shape[1]) - whole[:, None]
    made = np.zeros_like(taps)
    for lag, weight in zip((-1, 0, 1, 2), _cubic(np.asarray(by_samples - whole)), strict=True):
        made += _at(knots, column - lag) * weight[:, None].astype(np.float32)
    return made


def _cubic(part: Floats) -> Floats:
    """Return the weights [4, n] of the knots about a place `part` [n] of a sample earlier."""
    other = 1 - part
    edge, inside = np.stack([other, part]) ** 3 / 6, np.stack([part, other]) ** 2
    near = 2 / 3 - inside + np.stack([part, other]) ** 3 / 2
    return np.stack([edge[0], near[0], near[1], edge[1]])


def with_pulse(taps: Complexes, fwhm_samples: float) -> Complexes:
    """Return bare taps with the pulse put on each of them."""
    pulse: Reals = table(fwhm_samples)[0, : 2 * HALF_WIDTH + 1]
    return convolved(taps, pulse.astype(np.float64))


def _at(taps: Complexes, column: np.ndarray) -> Complexes:
    """Return the taps at `column` [n, G], zero outside."""
    inside = (column >= 0) & (column < taps.shape[1])
    picked = np.take_along_axis(taps, np.clip(column, 0, taps.shape[1] - 1), axis=1)
    return np.where(inside, picked, np.complex64(0))
