"""Where the pulse of the first path has its top in CIRs of whatever receiver.

Some report the edge of the first path, some its top, and some where a weak threshold is crossed. So
the index alone tells neither how strong the first path is nor where its pulse lies; samples do.
"""

from __future__ import annotations

from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from bench.physics.units import Complexes, Floats, Reals, absolute

SPAN_FWHM: Final = 1.5  # pulse widths behind the index, within which the top lies [convention]
RIPPLE: Final = 0.5  # of the highest sample within, below which a top is the noise's [convention]
LEAST_BEND: Final = 1e-6  # of the logarithm from sample to sample: less is flat [rounding]
STEPS: Final = (-1, 0, 1)  # the samples that tell a top: one, and those beside it


def first_top(taps: Complexes, index: Floats, fwhm: float) -> tuple[Floats, Complexes]:
    """Return the place of the first path's top [n], in samples, and the CIR's value there [n].

    The first top of `taps` [n, K] from the first path's `index` [n] on, of pulses that are `fwhm`
    samples wide; between samples as a parabola of the logarithm, which a Gaussian pulse is. The
    highest sample where there is no top.
    """
    place = _highest(absolute(taps), index, ceil(SPAN_FWHM * fwhm) + 1)
    near = [_beside(taps, place[:, None], step)[:, 0] for step in STEPS]
    sizes = (np.maximum(np.abs(one).astype(np.float64), np.finfo(np.float32).tiny) for one in near)
    before, here, after = map(np.log, sizes)
    bend = np.minimum(before - 2 * here + after, -LEAST_BEND)
    off = np.clip((before - after) / (2 * bend), -0.5, 0.5)
    value = near[1] * np.exp((after - before) * off / 4)
    return place + off, value.astype(np.complex64)


def _highest(size: Reals, index: Floats, span: int) -> NDArray[np.intp]:
    """Return the sample of the first top [n] of magnitudes [n, K] within `span` of an index."""
    last = size.shape[1] - 1
    begin = np.clip(np.floor(np.nan_to_num(index)), 0, last).astype(np.intp)
    places = np.minimum(begin[:, None] + np.arange(span), last)
    before, here, after = (_beside(size, places, step) for step in STEPS)
    top = (here >= before) & (here >= after) & (here >= RIPPLE * here.max(axis=1, keepdims=True))
    found = np.where(top.any(axis=1), top.argmax(axis=1), here.argmax(axis=1))
    return np.asarray(places[np.arange(len(places)), found])


def _beside(values: NDArray[Any], places: NDArray[np.intp], step: int) -> NDArray[Any]:
    """Return values [n, K] so many samples beside places [n, m]; at an end that of the end."""
    return np.take_along_axis(values, np.clip(places + step, 0, values.shape[1] - 1), axis=1)
