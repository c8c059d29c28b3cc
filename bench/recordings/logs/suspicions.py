"""What looks wrong in a table, each with its likely cause. Nothing is repaired."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.clean import cir_lengths
from bench.recordings.logs.registers import ACCUMULATOR_SAMPLES
from bench.recordings.table import FLOAT_COLUMNS

Floats = NDArray[np.float64]
FARTHEST_M = 300.0  # beyond what UWB radios reach
LIKELY_DBM = (-130.0, -20.0)
TOLERANCE = 0.2  # how near a ratio must be to a unit's
ABSURD_M = (1e-3, 1e6)  # medians outside are no range in any unit taken for metres
RATIOS = {1000.0: "millimetres", 100.0: "centimetres", 3.2808: "feet"}


def suspicions(frame: pd.DataFrame) -> list[str]:
    """Return one line per thing that looks wrong in a table of the exchange format's columns."""
    found = [*_lengths(frame), *_sign(frame), *_first_path(frame)]
    return [*found, *_levels(frame), *_infinite(frame)]


def _numbers(frame: pd.DataFrame, column: str) -> Floats:
    """Return the finite numbers of a column; none where it is not there."""
    if column not in frame:
        return np.empty(0)
    values = pd.to_numeric(frame[column], errors="coerce").to_numpy(np.float64)
    return np.asarray(values[np.isfinite(values)], np.float64)


def _lengths(frame: pd.DataFrame) -> Iterator[str]:
    """Yield ranges that are not in metres."""
    columns = ("range_m", "true_range_m")
    medians = {c: float(np.median(v)) for c in columns if len(v := _numbers(frame, c))}
    far = [column for column, median in medians.items() if median > FARTHEST_M]
    absurd = {c: m for c, m in medians.items() if m > 0 and not ABSURD_M[0] < m < ABSURD_M[1]}
    if absurd:
        yield from _absurd(absurd)
    elif len(far) == 2:
        yield (
            f"range_m and true_range_m: median {medians['range_m']:.0f} and "
            f"{medians['true_range_m']:.0f} m; probably millimetres (or centimetres) taken for "
            "metres: give the unit, as in --map range=COLUMN:mm,true_range=COLUMN:mm"
        )
    elif len(medians) == 2:
        yield from _ratio(medians["range_m"], medians["true_range_m"])
    if len(errors := _numbers(frame, "error_m")) and np.median(np.abs(errors)) > FARTHEST_M / 10:
        yield (
            f"error_m: median magnitude {np.median(np.abs(errors)):.0f} m; probably millimetres "
            "taken for metres: give the unit, as in --map error=COLUMN:mm"
        )


def _absurd(medians: dict[str, float]) -> Iterator[str]:
    """Yield lengths that are none of a radio's whatever common unit they are in."""
    for column, median in medians.items():
        name = column.removesuffix("_m")
        yield (
            f"{column}: median {median:.3g} m, which no UWB range is; probably a wrong unit: "
            f"expected one such as m, cm or mm, as in --map {name}=COLUMN:mm"
        )


def _ratio(measured_m: float, true_m: float) -> Iterator[str]:
    """Yield where one of the two lengths is in another unit than the other."""
    if min(measured_m, true_m) <= 0:
        return
    big, small = ("range", "true_range") if measured_m > true_m else ("true_range", "range")
    ratio = max(measured_m, true_m) / min(measured_m, true_m)
    for factor, unit in RATIOS.items():
        if abs(ratio / factor - 1) < TOLERANCE:
            yield (
                f"{big}_m is typically {ratio:.3g} times {small}_m; probably {unit} taken for "
                f"metres: give the unit, as in --map {big}=COLUMN:{_short(unit)}"
            )


def _short(unit: str) -> str:
    return {"millimetres": "mm", "centimetres": "cm", "feet": "ft"}[unit]


def _sign(frame: pd.DataFrame) -> Iterator[str]:
    """Yield an error that is true - measured."""
    if not {"error_m", "range_m", "true_range_m"} <= set(frame.columns):
        return
    columns = ("error_m", "range_m", "true_range_m")
    error, measured, true = (pd.to_numeric(frame[c], errors="coerce") for c in columns)
    difference = measured - true
    opposite = (error + difference).abs().median() < 1e-3 * difference.abs().median()
    if opposite:
        yield "error_m is true - measured range; expected measured - true: leave it out"


def _first_path(frame: pd.DataFrame) -> Iterator[str]:
    """Yield a first path in the register's fixed-point form."""
    index = _numbers(frame, "first_path_index")
    width = ACCUMULATOR_SAMPLES
    if "cir" in frame and (lengths := cir_lengths(frame["cir"])).any():
        width = int(lengths.max())
    if len(index) and np.median(index) >= max(width, ACCUMULATOR_SAMPLES):
        yield (
            f"first_path_index: median {np.median(index):.0f}, beyond the accumulator's "
            f"{ACCUMULATOR_SAMPLES} samples; probably the raw register FP_INDEX in 10.6 fixed "
            "point: --map first_path_index=COLUMN:10.6"
        )


def _levels(frame: pd.DataFrame) -> Iterator[str]:
    """Yield levels no receiver of this kind reports."""
    for column in ("rx_power_dbm", "first_path_power_dbm"):
        values = _numbers(frame, column)
        if len(values) and not LIKELY_DBM[0] < np.median(values) < LIKELY_DBM[1]:
            yield (
                f"{column}: median {np.median(values):.1f} dBm; expected {LIKELY_DBM[0]:.0f} to "
                f"{LIKELY_DBM[1]:.0f} (a sign lost, or a raw register?)"
            )


def _infinite(frame: pd.DataFrame) -> Iterator[str]:
    """Yield unknown columns with infinities, which no rule drops."""
    for column in frame:
        if column in FLOAT_COLUMNS or not pd.api.types.is_float_dtype(frame[column]):
            continue
        count = int(np.isinf(frame[column].to_numpy(np.float64, na_value=np.nan)).sum())
        if count:
            yield (
                f"column {column!r} holds {count} infinite value(s); probably a level of no power: "
                "kept, since the column is not known; map it (--map rx_power=...) to have such "
                "rows dropped"
            )
