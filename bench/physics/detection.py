"""Leading-edge detection on the accumulator's magnitude.

As the DW1000 does it (user manual 7.2.47 and application note APS006 part 1): the first rising edge
above a multiple of the noise; the first-path index sits at half of that edge's peak, in 1/64 of a
sample.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.physics.pulse import HALF_WIDTH, shape
from bench.physics.units import Floats, Reals

_CLIMB = 4  # samples from the first crossing to the peak of its edge, at most


def first_path(magnitude: Reals, threshold: Floats) -> Floats:
    """Return the first-path index [n] in samples of `magnitude` [n, S], `threshold` [n] counts.

    Where nothing exceeds the threshold, the strongest sample's edge is taken.
    """
    above = magnitude > threshold[:, None]
    crossing = np.where(above.any(axis=1), above.argmax(axis=1), magnitude.argmax(axis=1))
    return half_height(magnitude, peak_after(magnitude, crossing))


def peak_after(magnitude: Reals, crossing: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the index [n] of the first local maximum at or after `crossing` [n]."""
    rows = np.arange(len(magnitude))
    last = magnitude.shape[1] - 1
    top = crossing.copy()
    for _ in range(_CLIMB):
        ahead = np.minimum(top + 1, last)
        top = np.where(magnitude[rows, ahead] > magnitude[rows, top], ahead, top)
    return top


def half_height(magnitude: Reals, top: NDArray[np.intp]) -> Floats:
    """Return where [n] the rising edge before `top` [n] crosses half its height, in 1/64."""
    rows = np.arange(len(magnitude))
    half = magnitude[rows, top] * np.float32(0.5)
    upper = top.copy()
    for _ in range(_CLIMB):
        before = np.maximum(upper - 1, 0)
        upper = np.where(magnitude[rows, before] > half, before, upper)
    lower = np.maximum(upper - 1, 0)
    low, high = magnitude[rows, lower], magnitude[rows, upper]
    rise = np.maximum(high - low, np.float32(1e-20))
    place = lower + np.clip((half - low) / rise, 0, 1)
    return np.rint(np.asarray(place, np.float64) * 64) / 64


@lru_cache(maxsize=32)
def edge_offset(fwhm_samples: float) -> float:
    """Return how far a clean pulse's centre lies behind its first-path index, in samples.

    Averaged over alignments: what the chip's calibrated antenna delay contains.
    """
    centre = 2 * HALF_WIDTH + np.arange(64)[:, None] / 64
    offsets = np.arange(4 * HALF_WIDTH)[None, :] - centre
    clean = np.asarray(np.abs(shape(offsets, fwhm_samples)), np.float32)
    found = first_path(clean, np.full(64, 0.3))
    return float(np.mean(centre[:, 0] - found))
