"""Truths that cannot be: in feet, swapped with the range, equal to it; a range that is hidden."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import hidden, numeric
from bench.discrepancy.data.observables import error_m
from bench.discrepancy.data.settings import (
    EXACT_M,
    FOOT_M,
    MOST_NEGATIVE,
    ONE_FACTOR,
    PLACES_APART,
    QUARTILES,
    READ_M,
)
from bench.errors import BenchError
from bench.physics.units import Floats
from bench.recordings.clean import NEGATIVE
from bench.recordings.places import distance_m
from bench.recordings.table import Recordings


def check_positive(recorded: Recordings) -> None:
    """Raise where many true distances were negative, as differences of distances are."""
    below = recorded.dropped.get(NEGATIVE, 0)
    rows = len(recorded.frame) + sum(recorded.dropped.values())
    if below > MOST_NEGATIVE * rows:
        raise BenchError(
            f"{recorded.at}: true_range_m is negative in {below} of {rows} rows: expected "
            "distances (differences of distances, TDoA, cannot be compared)"
        )


def check_truth(frame: pd.DataFrame, source: str) -> None:
    """Raise BenchError where truth and range cannot both be what their columns say."""
    range_m, truth_m = numeric(frame, "range_m"), numeric(frame, "true_range_m")
    between_m = distance_m(frame)
    if _in_feet(range_m, truth_m):
        raise BenchError(
            f"{source}: range_m and true_range_m differ by the factor of feet and metres: "
            "expected metres in both"
        )
    if _in_feet(between_m, truth_m):
        raise BenchError(
            f"{source}: the positions tx_x_m .. rx_z_m and true_range_m differ by the factor of "
            "feet and metres: expected metres in both"
        )
    if _middle(between_m - range_m) < EXACT_M and _middle(between_m - truth_m) > READ_M:
        raise BenchError(
            f"{source}: range_m is the distance between the positions, true_range_m is not: "
            "are the two swapped?"
        )
    if _middle(_log_ratios(between_m, truth_m)) > np.log(PLACES_APART):
        raise BenchError(
            f"{source}: the positions tx_x_m .. rx_z_m are {_middle(between_m - truth_m):.3g} m "
            "nearer or farther than true_range_m in the median: expected both of one survey in "
            "metres; leave out the columns that are not"
        )
    if _same(error_m(frame)):
        raise BenchError(
            f"{source}: the range error is 0 in every row: expected measured ranges, not the truth"
        )


def check_hidden(frame: pd.DataFrame, columns: tuple[str, ...], source: str) -> None:
    """Raise BenchError where hiding columns leaves neither range errors nor waveforms [n]."""
    left = hidden(frame, columns)
    before, after = (np.isfinite(error_m(one)).any() for one in (frame, left))
    if before and not after and "cir" not in left:
        raise BenchError(
            f"{source}: with {', '.join(columns)} hidden no range error is left, so that nothing "
            "could be said of ranges: hide other columns, or take --observe rx_power_dbm to "
            "compare levels only"
        )


def _in_feet(one_m: Floats, other_m: Floats) -> bool:
    """Return whether lengths [n] differ by one factor, that of feet and metres, at all lengths.

    A constant offset has another factor at another length.
    """
    ratios = _log_ratios(one_m, other_m)
    both = np.isfinite(ratios)
    if not both.any():
        return False
    low, middle, high = np.percentile(ratios[both], QUARTILES)
    short, _, long = np.percentile(np.log(other_m[both]), QUARTILES)
    factor = abs(abs(middle) + np.log(FOOT_M)) < ONE_FACTOR
    return bool(factor and high - low < ONE_FACTOR and long - short > 2 * ONE_FACTOR)


def _log_ratios(one_m: Floats, other_m: Floats) -> Floats:
    """Return the logarithms of ratios of lengths [n], NaN where one is not known or nothing."""
    known = np.isfinite(one_m) & np.isfinite(other_m) & (one_m > 0) & (other_m > 0)
    ratios = np.divide(one_m, other_m, out=np.full(len(one_m), np.nan), where=known)
    return np.asarray(np.log(ratios), np.float64)


def _middle(values: Floats) -> float:
    """Return the median size of values [n] that are known, NaN where none is."""
    known = np.abs(values[np.isfinite(values)])
    return float(np.median(known)) if len(known) else float("nan")


def _same(error: Floats) -> bool:
    """Return whether measured ranges are the true ones, in all rows [n] that are known."""
    known = error[np.isfinite(error)]
    return len(known) > 0 and not known.any()
