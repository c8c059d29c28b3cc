"""A stuck bit in the word of a range, seen by readings that never come.

A bit that is always set, or never, leaves one half of every period of twice its weight empty,
whatever the distance. No effect on the air knows that period; a delay and scatter would be named
for what the bit does in the mean.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import kstest

from bench.discrepancy.data.columns import numeric
from bench.discrepancy.select.recorder import spoilt
from bench.discrepancy.select.settings import (
    BIT_BIN_M,
    BIT_EMPTY,
    BIT_FILLED,
    BIT_LINKS,
    BIT_OVERSAMPLED,
    BIT_PERIOD_M,
    BIT_ROWS,
    BIT_TRIES,
    BIT_UNEVEN_P,
)
from bench.discrepancy.select.state import Round, Search, Selection, State
from bench.discrepancy.select.stepwise import locate_left
from bench.physics.units import Floats


def spoilt_ranges(state: State) -> Selection | None:
    """Return what can be said where a bit of the ranges is stuck, None where none is."""
    fault = stuck_bit(state.search)
    if not fault:
        return None
    located = locate_left(state.search, (), 0)
    return spoilt(state.after(Round(located, None, None)), fault) if located.significant else None


def stuck_bit(search: Search) -> str:
    """Return in words which bit of the ranges is stuck, "" where none is seen."""
    rows = search.sharpest
    if "range_m" not in rows.frame or len(np.unique(rows.links)) < BIT_LINKS:
        return ""
    measured, true = numeric(rows.frame, "range_m"), rows.scene.true_range_m
    known = np.isfinite(measured) & np.isfinite(true)
    bit_m = stuck_bit_m(measured[known], true[known])
    if bit_m is None:
        return ""
    return (
        f"a bit of the ranges is stuck: readings leave {bit_m:.4g} m of every "
        f"{2 * bit_m:.4g} m empty, at all distances"
    )


def stuck_bit_m(measured_m: Floats, true_m: Floats) -> float | None:
    """Return the weight in metres of a bit that is stuck in ranges [n], None where none is.

    True ranges [n] must lie in the half that is empty, too: else places lie so.
    """
    if len(measured_m) < BIT_ROWS:
        return None
    for frequency in _likely(measured_m, true_m):
        if _half_empty(measured_m * frequency, true_m * frequency):
            return float(0.5 / frequency)
    return None


def _likely(measured_m: Floats, true_m: Floats) -> Floats:
    """Return the frequencies per metre at which readings crowd most, and true ranges do not."""
    end = max(float(measured_m.max()), float(true_m.max())) + BIT_BIN_M
    start = min(float(measured_m.min()), float(true_m.min()))
    size = int(2 ** np.ceil(np.log2(BIT_OVERSAMPLED * (end - start) / BIT_BIN_M)))
    step = 1 / (size * BIT_BIN_M)
    low, high = (int(1 / (period * step)) for period in BIT_PERIOD_M[::-1])
    crowd = [_resultants(v - start, size)[low:high] for v in (measured_m, true_m)]
    peaks = low + np.argsort(crowd[1] - crowd[0])[:BIT_TRIES]
    fine = np.linspace(-0.5, 0.5, BIT_OVERSAMPLED)
    return np.asarray(((peaks[:, None] + fine) * step).ravel())


def _resultants(values_m: Floats, size: int) -> Floats:
    """Return the mean resultant length of values [n] at frequencies of an FFT [size / 2 + 1]."""
    counts = np.bincount((values_m / BIT_BIN_M).astype(np.intp), minlength=size)
    return np.asarray(np.abs(np.fft.rfft(counts[:size])) / len(values_m))


def _half_empty(measured: Floats, true: Floats) -> bool:
    """Return whether readings [n], in periods, fill one half evenly and leave the other empty."""
    phases = np.sort(measured % 1)
    gaps = np.diff(phases, append=phases[0] + 1)
    widest = int(np.argmax(gaps))
    gap = float(gaps[widest])
    if not BIT_EMPTY[0] < gap < BIT_EMPTY[1]:
        return False
    begin = phases[widest] + gap  # of what is filled
    filled, other = (measured - begin) % 1 / (1 - gap), (true - begin) % 1 / (1 - gap)
    even = kstest(filled, "uniform").pvalue > BIT_UNEVEN_P
    return bool(even and np.mean(other > 1) > BIT_FILLED)
