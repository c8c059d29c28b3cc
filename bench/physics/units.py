"""Constants and conversions of ultra-wideband ranging. Lengths in metres, delays in nanoseconds.

DW1000 constants: Decawave, DW1000 User Manual 2.11, sections 4.7 (powers) and 7.2 (registers).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

C_M_PER_NS = 0.299792458
TIMESTAMP_TICK_NS = 1e3 / (128 * 499.2)  # 15.65 ps = 4.69 mm
POWER_OFFSET_DB = {16: 113.77, 64: 121.74}  # the manual's constant A, by pulse repetition MHz
CENTRE_GHZ = {1: 3.4944, 2: 3.9936, 3: 4.4928, 4: 3.9936, 5: 6.4896, 7: 6.4896, 9: 7.9872}

Floats = NDArray[np.float64]
Reals = NDArray[np.float32]
Complexes = NDArray[np.complex64]


def amplitude(decibel: Floats | float) -> Floats:
    """Return the amplitude ratio of a power ratio in dB."""
    return np.asarray(10.0 ** (np.asarray(decibel, np.float64) / 20))


def decibel(power: Any) -> Floats:
    """Return 10 log10 of a power ratio; zero power gives -300 dB."""
    return np.asarray(10 * np.log10(np.maximum(np.asarray(power, np.float64), 1e-30)))


def wavelength_m(centre_ghz: float) -> float:
    """Return the wavelength in metres at a centre frequency in GHz."""
    return C_M_PER_NS / centre_ghz


def phasor(turns: Reals) -> Complexes:
    """Return exp(2 pi i turns) of some `turns`, to single precision: cheapest near zero."""
    angle = np.asarray(turns, np.float32) * np.float32(2 * np.pi)
    made = np.empty(angle.shape, np.complex64)
    np.cos(angle, out=made.real)
    np.sin(angle, out=made.imag)
    return made


def scaled(values: Complexes, by: Reals, out: Complexes | None = None) -> Complexes:
    """Return rows of `values` [n, S] times real `by` [n], which numpy would make complex first.

    Into `out` where it is given, which may be `values`.
    """
    flat = np.ascontiguousarray(values, np.complex64).view(np.float32)
    made: Any = np.multiply(flat, by[:, None], out=None if out is None else out.view(np.float32))
    return np.asarray(made.view(np.complex64))


def squared(values: Complexes) -> Reals:
    """Return |values|^2, several times faster than numpy's hypot-based abs."""
    made = np.square(values.real)
    made += np.square(values.imag)
    return np.asarray(made, np.float32)


def absolute(values: Complexes) -> Reals:
    """Return |values|, several times faster than numpy's hypot-based abs."""
    made = squared(values)
    return np.asarray(np.sqrt(made, out=made), np.float32)


def energy(values: Complexes) -> Reals:
    """Return sum |values|^2 [n] over the samples of each row [n, S]."""
    flat = np.ascontiguousarray(values).view(np.float32)
    return np.asarray(np.einsum("ns,ns->n", flat, flat))
