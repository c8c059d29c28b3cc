"""Figures that no instrument reads, in their columns' units: one clear line each."""

from __future__ import annotations

from typing import Final

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.settings import (
    DEEPEST_SAMPLE,
    FAINTEST_DBM,
    LARGEST_FIGURE,
    LATEST_S,
    LONGEST_REPLY_S,
    LOUDEST_DBM,
    TEMPERATURES_C,
    WILD,
)
from bench.errors import BenchError
from bench.recordings.clean import LEVEL_COLUMNS

MEDIANS: Final = {
    "reply_time_s": ((0.0, LONGEST_REPLY_S), "s", "seconds (milli- or microseconds?)"),
    "time_s": ((-LATEST_S, LATEST_S), "s", "seconds (milli- or nanoseconds?)"),
    "temperature_c": (TEMPERATURES_C, "degC", "degrees Celsius (kelvin?)"),
    **dict.fromkeys(LEVEL_COLUMNS, ((FAINTEST_DBM, LOUDEST_DBM), "dBm", "dBm (another unit?)")),
}  # column: what its median lies in, the unit, what is expected


def check_figures(frame: pd.DataFrame, source: str) -> None:
    """Raise BenchError where a column holds what no instrument reads, naming column and unit.

    Ranges are looked at elsewhere.
    """
    _check_levels(frame, source)
    _check_largest(frame, source)
    _check_medians(frame, source)
    _check_single(frame, source)
    _check_magnitudes(frame, source)


def typical(frame: pd.DataFrame, name: str) -> float:
    """Return the median of a column's numbers, 1 where it has none."""
    values = numeric(frame, name)
    return float(np.nanmedian(values)) if np.isfinite(values).any() else 1.0


def _check_largest(frame: pd.DataFrame, source: str) -> None:
    """Raise where a column holds a figure that is none in any unit."""
    for name in frame.columns.difference(["range_m", "true_range_m", "error_m"]):
        if frame[name].dtype.kind not in "fiu":
            continue
        values = numeric(frame, name)
        wild = np.flatnonzero(np.isfinite(values) & (np.abs(values) > LARGEST_FIGURE))
        if len(wild):
            value, row = frame[name].iloc[wild[0]], int(wild[0])
            raise BenchError(f"{source}: {name} is {value:.4g} at row {row}: no measurement")


def _check_levels(frame: pd.DataFrame, source: str) -> None:
    """Raise where levels are above any that a UWB receiver gets: no dBm, or their sign was lost."""
    for name in LEVEL_COLUMNS:
        values = numeric(frame, name)
        known = values[np.isfinite(values)]
        if len(known) and (known.min() > 0 or np.median(known) > LOUDEST_DBM):
            raise BenchError(
                f"{source}: the median of {name} is {np.median(known):.4g} dBm: expected received "
                "levels, far below 0 dBm (was the sign lost, or are they milliwatts?)"
            )
        loud = np.flatnonzero(values > LOUDEST_DBM)
        if len(loud):
            raise BenchError(
                f"{source}: {name} is {values[loud[0]]:.4g} dBm at row {loud[0]} ({len(loud)} of "
                f"{len(known)} rows are above {LOUDEST_DBM:.4g}): nobody receives that; expected "
                "levels far below 0 dBm (was the sign lost there?)"
            )


def _check_medians(frame: pd.DataFrame, source: str) -> None:
    """Raise where a column's median is of another unit; single rows may be read wrong."""
    for name, ((low, high), unit, expected) in MEDIANS.items():
        values = numeric(frame, name)
        known = values[np.isfinite(values)]
        middle = float(np.median(known)) if len(known) else low
        if not low <= middle <= high:
            raise BenchError(
                f"{source}: the median of {name} is {middle:.4g} {unit}: expected {expected}"
            )


def _check_single(frame: pd.DataFrame, source: str) -> None:
    """Raise where a single row is a thousand times beyond what a column's median may be."""
    for name, ((low, high), unit, expected) in MEDIANS.items():
        values = numeric(frame, name)
        wild = np.flatnonzero(np.abs(values) > WILD * max(-low, high))
        if len(wild):
            rows = f"{len(wild)} row{'s' if len(wild) > 1 else ''}"
            raise BenchError(
                f"{source}: {name} is {values[wild[0]]:.4g} {unit} at row {wild[0]} ({rows} like "
                f"it): no instrument reads that; expected {expected}; drop these rows, or leave "
                "the cells empty"
            )


def _check_magnitudes(frame: pd.DataFrame, source: str) -> None:
    """Raise where a CIR goes far below zero: a real part, or another sign, is no magnitude."""
    for row, cir in enumerate(frame.get("cir", ())):
        if not isinstance(cir, np.ndarray) or not len(cir):
            continue
        least = float(cir.min())
        if least < 0 and -least > DEEPEST_SAMPLE * float(np.abs(cir).max()):
            raise BenchError(f"{source}: cir is {least:.4g} in row {row}: expected magnitudes")
