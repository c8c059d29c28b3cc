"""Figures of a CIR's shape in one pass per row, compiled by numba when first run.

numpy would walk every waveform some thirty times; a diagnosis asks for these figures of every
simulated waveform, so this is where its time went.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.compiled import compiled
from bench.discrepancy.settings import EARLY_FEWEST, NOISE_BEFORE_NS

Floats = NDArray[np.float64]
COLUMNS = ("total", "peak", "rise", "excess", "spread", "kurtosis", "lead", "early")
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
    compiled(powers)(magnitude, delay, out)
    compiled(profile)(magnitude, delay, np.array(edges), out, bins)
    compiled(moments)(magnitude, delay, out)
    compiled(crossings)(magnitude, delay, noise, np.array(levels), out)
    compiled(early)(magnitude, delay, NOISE_BEFORE_NS, out)
    return dict(zip(COLUMNS, out.T, strict=True)), bins


def cut(
    cir: Floats, first: Floats, period: Floats, before: int, made: Floats, delay: Floats
) -> None:
    """Write to `made` [n, K] samples of `cir` [n, S] from `before` ahead of `first` [n] on.

    NaN where there are none; `delay` [n, K] is how far they lie behind `first`, by the `period`.
    """
    samples = cir.shape[1]
    for row in range(made.shape[0]):
        known = not np.isnan(first[row])
        start = (int(np.floor(first[row])) if known else 0) - before
        low = min(max(0, -start), made.shape[1]) if known else made.shape[1]
        high = max(low, min(made.shape[1], samples - start))
        made[row, :low] = np.nan
        made[row, high:] = np.nan
        for k in range(high - low):
            made[row, low + k] = cir[row, start + low + k]
        for k in range(made.shape[1]):
            delay[row, k] = (start + k - first[row]) * period[row]


def powers(magnitude: Floats, delay: Floats, out: Floats) -> None:
    """Write total and excess of every row to `out` [n, 8]."""
    for row in range(magnitude.shape[0]):
        sizes, delays = magnitude[row], delay[row]
        total = tilt = 0.0
        for k in range(len(sizes)):
            power = 0.0 if np.isnan(sizes[k]) else float(sizes[k]) ** 2
            total += power
            tilt += power * delays[k]
        out[row, 0] = total
        if total > 0:
            out[row, 3] = tilt / total


def profile(magnitude: Floats, delay: Floats, edges: Floats, out: Floats, bins: Floats) -> None:
    """Write the peak of every row to `out` [n, 8], its mean power in each bin to `bins` [n, B]."""
    count, last = np.empty(bins.shape[1]), bins.shape[1] - 1
    for row in range(magnitude.shape[0]):
        peak, b = 0.0, 0
        count[:] = bins[row] = 0.0
        for k in range(magnitude.shape[1]):
            size, at = float(magnitude[row, k]), delay[row, k]
            while b > 0 and at < edges[b]:  # delays mostly grow, so the bin is a step away
                b -= 1
            while b < last and at >= edges[b + 1]:
                b += 1
            if not np.isnan(size):
                peak = max(peak, size)
                if edges[b] <= at < edges[b + 1]:
                    bins[row, b] += size**2
                    count[b] += 1.0
        out[row, 1] = peak
        for b in range(last + 1):
            bins[row, b] = bins[row, b] / count[b] if count[b] > 0 else np.nan


def moments(magnitude: Floats, delay: Floats, out: Floats) -> None:
    """Write spread and kurtosis of every row to `out` [n, 8], whose total and excess are there."""
    for row in range(magnitude.shape[0]):
        sizes, delays, excess = magnitude[row], delay[row], out[row, 3]
        known, mean = 0, 0.0
        for k in range(len(sizes)):
            known += not np.isnan(sizes[k])
            mean += 0.0 if np.isnan(sizes[k]) else sizes[k]
        mean /= max(known, 1)
        second = fourth = wide = 0.0
        for k in range(len(sizes)):
            size = mean if np.isnan(sizes[k]) else float(sizes[k])
            step = (size - mean) ** 2
            second += step
            fourth += step * step
            wide += 0.0 if np.isnan(sizes[k]) else size**2 * (delays[k] - excess) ** 2
        if second > 0:
            out[row, 4] = np.sqrt(wide / out[row, 0])
            out[row, 5] = fourth * known / second**2


def early(magnitude: Floats, delay: Floats, before_ns: float, out: Floats) -> None:
    """Write to `out` [n, 8] how samples before `before_ns` scatter, as a share of their mean."""
    for row in range(magnitude.shape[0]):
        known, total, power = 0, 0.0, 0.0
        for k in range(magnitude.shape[1]):
            size = float(magnitude[row, k])
            if delay[row, k] < before_ns and not np.isnan(size):
                known += 1
                total += size
                power += size**2
        if known >= EARLY_FEWEST and total > 0:
            out[row, 7] = np.sqrt(max(power * known / total**2 - 1, 0.0))


def crossings(magnitude: Floats, delay: Floats, noise: Floats, levels: Floats, out: Floats) -> None:
    """Write rise and lead of every row to `out` [n, 8], whose peak is there."""
    limits, at = np.empty(3), np.empty(3)
    for row in range(magnitude.shape[0]):
        limits[0], at[:] = levels[0] * out[row, 1], np.nan
        limits[1:] = levels[1:] * noise[row]
        for which in range(3):
            for k in range(magnitude.shape[1]):
                if (0.0 if np.isnan(magnitude[row, k]) else magnitude[row, k]) >= limits[which]:
                    at[which] = delay[row, k]
                    break
        out[row, 2] = at[0] - at[1]
        out[row, 6] = -at[2]
