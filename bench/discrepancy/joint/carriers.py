"""Whether samples that hold nothing but noise go together over many samples, as carriers make them.

A receiver's noise has the colour of its filter: samples that are some apart have nothing in common.
Two carriers of an interferer beat, and so do many: the power of samples goes up and down together
over their distance, however like noise their sum is at every one (six with phases of their own
scatter by all but a sixth of what noise does). A tail that is left in late samples goes with the
distance, too, but smoothly.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from bench.discrepancy.joint.quiet_moments import relative_power
from bench.discrepancy.joint.settings import (
    CARRIED_FEWEST,
    CARRIED_LAGS,
    CARRIED_P,
    CARRIED_PAIRS,
    COLOUR_SAMPLES,
)
from bench.discrepancy.joint.statistics import Floats

Mask = NDArray[np.bool_]


def carried(recorded: Floats, simulated: Sequence[Floats], quiet: Mask) -> bool:
    """Return whether recorded magnitudes [n, K] go together where they are `quiet` [K].

    Beyond what simulated ones do, each [n, K], by a test over all distances.
    """
    lags = _lags(quiet)
    if len(lags) < CARRIED_FEWEST:
        return False
    ours, theirs = together(recorded, quiet, lags), [together(o, quiet, lags) for o in simulated]
    left = ours.mean(axis=0) - np.mean([one.mean(axis=0) for one in theirs], axis=0)
    error = ours.std(axis=0) / np.sqrt(len(ours)) * np.sqrt(1 + 1 / len(theirs))
    wave = left - np.polyval(np.polyfit(lags, left, 1), lags)
    square = float(np.sum((wave / np.maximum(error, np.finfo(float).tiny)) ** 2))
    return bool(chi2.sf(square, len(lags) - 2) < CARRIED_P)


def together(magnitude: Floats, quiet: Mask, lags: NDArray[np.intp]) -> Floats:
    """Return the mean products of powers of samples so far apart [n, lags], of rows [n, K].

    Of powers over their means, less one, where both samples are `quiet` [K]; 0 where none is known.
    """
    power = relative_power(np.where(quiet, magnitude, np.nan)) - 1
    known, power = np.isfinite(power), np.nan_to_num(power)
    sums = np.stack([(power[:, lag:] * power[:, :-lag]).sum(axis=1) for lag in lags], axis=1)
    pairs = np.stack([(known[:, lag:] & known[:, :-lag]).sum(axis=1) for lag in lags], axis=1)
    return np.asarray(sums / np.maximum(pairs, 1))


def _lags(quiet: Mask) -> NDArray[np.intp]:
    """Return the distances in samples that are looked at: where enough pairs are `quiet`."""
    every = np.arange(COLOUR_SAMPLES, CARRIED_LAGS + 1)
    pairs = [np.count_nonzero(quiet[lag:] & quiet[:-lag]) for lag in every]
    return np.asarray(every[np.array(pairs) >= CARRIED_PAIRS], np.intp)
