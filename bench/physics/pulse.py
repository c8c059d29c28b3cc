"""The pulse a path leaves in the accumulator, tabulated between samples.

Gaussian in magnitude: a full width of 2.5 samples at half magnitude gives a -10 dB bandwidth of
460 MHz (the channel's 499.2 MHz of IEEE 802.15.4-2011, 14.4.5), and the rising edge of recorded
accumulators (about 0.02, 0.2 and 0.7 of the peak 3, 2 and 1 samples before it, no leading side
lobe: apartment logs, Zenodo 10.5281/zenodo.4742391). Ringing behind it is an effect of its own.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from bench.physics.units import Complexes, Floats, Reals

HALF_WIDTH = 4  # samples on either side of the centre; beyond, the pulse is under 0.1 %
STEPS = 64  # positions between two samples, the resolution of the chip's first-path index


def shape(offset_samples: Floats, fwhm_samples: float) -> Floats:
    """Return the pulse (peak 1) at offsets from its centre; `fwhm_samples` wide at one half."""
    scaled = np.asarray(offset_samples, np.float64) / fwhm_samples
    return np.asarray(np.exp(-4 * np.log(2) * scaled**2))


@lru_cache(maxsize=32)
def table(fwhm_samples: float) -> Reals:
    """Return the pulse [STEPS + 1, 2 HALF_WIDTH + 2] of unit energy.

    Row `s` holds the samples at -HALF_WIDTH .. HALF_WIDTH + 1 of a pulse centred at s / STEPS.
    """
    centre = np.arange(STEPS + 1)[:, None] / STEPS
    offsets = np.arange(-HALF_WIDTH, HALF_WIDTH + 2)[None, :] - centre
    values = shape(offsets, fwhm_samples)
    energy = np.mean(np.sum(values[:-1] ** 2, axis=1))
    return np.asarray(values / np.sqrt(energy), np.float32)


def peak(fwhm_samples: float) -> float:
    """Return the peak magnitude of the pulse of unit energy."""
    return float(table(fwhm_samples)[0, HALF_WIDTH])


def lobe_phases(size: Reals) -> Complexes:
    """Return a random phase for every lobe of magnitudes [n, K], alike within it, as e^(j phase).

    A lobe reaches from one local minimum to the next: a pulse is one.
    """
    begins = np.zeros(size.shape, bool)
    begins[:, 1:-1] = (size[:, 1:-1] <= size[:, :-2]) & (size[:, 1:-1] < size[:, 2:])
    drawn = np.random.default_rng(0).random(size.shape)
    turns = np.take_along_axis(drawn, np.cumsum(begins, axis=1), axis=1)
    return np.asarray(np.exp(2j * np.pi * turns), np.complex64)
