"""Figures of a CIR's shape in one pass per row, compiled by numba when first run.

numpy would walk every waveform some thirty times; a diagnosis asks for these figures of every
simulated waveform, so this is where its time went.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
COLUMNS = ("total", "peak", "rise", "excess", "spread", "kurtosis", "lead")
Levels = tuple[float, float, float]


def shape_figures(
    magnitude: Floats, delay: Floats, noise: Floats, edges: tuple[float, ...], levels: Levels
) -> tuple[dict[str, Floats], Floats]:
    """Return figures by the names of COLUMNS, each [n], and mean power per delay bin [n, B].

    `magnitude`, `delay` [n, K] (NaN = not there), `noise` std [n], bin `edges` [B + 1] in ns.
    `levels`: rise from multiples of the noise to a share of the maximum, lead from multiples of
    the noise (share, rise multiple, lead multiple). NaN where a figure is not defined.
    """
    out = np.full((len(magnitude), len(COLUMNS)), np.nan)
    bins = np.full((len(magnitude), len(edges) - 1), np.nan)
    compiled(powers)(magnitude, delay, np.array(edges), out, bins)
    compiled(moments)(magnitude, delay, out)
    compiled(crossings)(magnitude, delay, noise, np.array(levels), out)
    return dict(zip(COLUMNS, out.T, strict=True)), bins


@lru_cache(maxsize=8)
def compiled(loop: Callable[..., None]) -> Callable[..., None]:
    """Return a loop as machine code that lets other threads run."""
    import numba

    made: Callable[..., None]
    try:
        made = numba.njit(nogil=True, cache=True)(loop)
    except RuntimeError:  # nowhere to keep the machine code: compile it in every process
        made = numba.njit(nogil=True)(loop)
    return made


def powers(magnitude: Floats, delay: Floats, edges: Floats, out: Floats, bins: Floats) -> None:
    """Write total, peak and excess of every row to `out` [n, 7], mean powers to `bins` [n, B]."""
    inside = np.empty(bins.shape[1])
    for row in range(magnitude.shape[0]):
        total = peak = tilt = 0.0
        bins[row] = 0.0
        inside[:] = 0.0
        for k in range(magnitude.shape[1]):
            power = float(magnitude[row, k]) ** 2
            if np.isnan(power):
                continue
            total += power
            tilt += power * delay[row, k]
            peak = max(peak, magnitude[row, k])
            for b in range(bins.shape[1]):
                if edges[b] <= delay[row, k] < edges[b + 1]:
                    bins[row, b] += power
                    inside[b] += 1.0
        for b in range(bins.shape[1]):
            bins[row, b] = bins[row, b] / inside[b] if inside[b] > 0 else np.nan
        out[row, 0] = total
        out[row, 1] = peak
        if total > 0:
            out[row, 3] = tilt / total


def moments(magnitude: Floats, delay: Floats, out: Floats) -> None:
    """Write spread and kurtosis of every row to `out` [n, 7], whose total and excess are there."""
    for row in range(magnitude.shape[0]):
        known, mean = 0, 0.0
        for k in range(magnitude.shape[1]):
            if not np.isnan(magnitude[row, k]):
                known += 1
                mean += magnitude[row, k]
        mean /= max(known, 1)
        second = fourth = wide = 0.0
        for k in range(magnitude.shape[1]):
            value = float(magnitude[row, k])
            if not np.isnan(value):
                step = (value - mean) ** 2
                second += step
                fourth += step * step
                wide += value**2 * (delay[row, k] - out[row, 3]) ** 2
        if second > 0:
            out[row, 4] = np.sqrt(wide / out[row, 0])
            out[row, 5] = fourth * known / second**2


def crossings(magnitude: Floats, delay: Floats, noise: Floats, levels: Floats, out: Floats) -> None:
    """Write rise and lead of every row to `out` [n, 7], whose peak is there."""
    for row in range(magnitude.shape[0]):
        high = low = early = np.nan
        for k in range(magnitude.shape[1]):
            value = magnitude[row, k]
            value = 0.0 if np.isnan(value) else value
            if np.isnan(high) and value >= levels[0] * out[row, 1]:
                high = delay[row, k]
            if np.isnan(low) and value >= levels[1] * noise[row]:
                low = delay[row, k]
            if np.isnan(early) and value >= levels[2] * noise[row]:
                early = delay[row, k]
        out[row, 2] = high - low
        out[row, 6] = -early
