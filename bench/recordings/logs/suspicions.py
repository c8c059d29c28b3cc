"""What looks wrong in a table, each with its likely cause. Nothing is repaired."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.clean import TRUTHS, cir_lengths
from bench.recordings.logs.registers import ACCUMULATOR_SAMPLES
from bench.recordings.table import FLOAT_COLUMNS

Floats = NDArray[np.float64]
FARTHEST_M = 300.0  # beyond what UWB radios reach
LIKELY_DBM = (-130.0, -20.0)
TOLERANCE = 0.2  # how near a ratio must be to a unit's
ABSURD_M = (1e-3, 1e6)  # medians outside are no range in any unit taken for metres
SHORT_M = 0.1  # shorter than in sight by more: no physics of a wall
MANY = 16  # numbers in a cell, which no other column of a log has
ISO = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")
NUMBER, LETTER = re.compile(r"-?[0-9]+(?:[.][0-9]+)?"), re.compile(r"[A-Za-z]{2}")
RATIOS = {1000.0: "millimetres", 100.0: "centimetres", 3.2808: "feet"}


def suspicions(frame: pd.DataFrame) -> list[str]:
    """Return one line per thing that looks wrong in a table of the exchange format's columns."""
    found = [
        *_lengths(frame),
        *_same(frame),
        *_sign(frame),
        *_exchanged(frame),
        *_first_path(frame),
    ]
    return [*found, *_dates(frame), *_unread_cir(frame), *_levels(frame), *_infinite(frame)]


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


def _same(frame: pd.DataFrame) -> Iterator[str]:
    """Yield ranges without any error."""
    if not {"range_m", "true_range_m"} <= set(frame) or len(frame) == 0:
        return
    if (frame["range_m"] == frame["true_range_m"]).all():
        yield (
            "range_m and true_range_m: the same in every row; probably one column taken for both, "
            "or the truth written where a measurement was meant: there is no error to learn"
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


def _exchanged(frame: pd.DataFrame) -> Iterator[str]:
    """Yield ranges that read short where nothing is in sight, as exchanged columns do."""
    if not {"los", "range_m", "true_range_m"} <= set(frame.columns):
        return
    measured, true = (pd.to_numeric(frame[c], errors="coerce") for c in ("range_m", "true_range_m"))
    seen = frame["los"].map(lambda one: TRUTHS.get(str(one).lower()))
    middle = (measured - true).groupby(seen).median()
    if middle.get(False, 0.0) < middle.get(True, 0.0) - SHORT_M:
        yield (
            f"without line of sight ranges read {middle.get(False, 0.0):.2f} m, with it "
            f"{middle.get(True, 0.0):.2f} m (median errors), but obstacles make ranges long: are "
            "range and true_range exchanged, or is the label the other way round "
            "(--map los=COLUMN:not)?"
        )


def _first_path(frame: pd.DataFrame) -> Iterator[str]:
    """Yield a first path in the register's form, or counted from another sample than the CIR's.

    The register holds whole numbers; what has a fraction was read in samples.
    """
    index, width = _numbers(frame, "first_path_index"), _width(frame)
    middle = float(np.median(index)) if len(index) else 0.0
    if middle < width:
        return
    if middle >= ACCUMULATOR_SAMPLES or (index == np.floor(index)).all():
        yield (
            f"first_path_index: median {middle:.0f}, beyond the {width} samples there are; "
            "probably the raw register FP_INDEX in 10.6 fixed point: "
            "--map first_path_index=COLUMN:10.6"
        )
    else:
        yield (
            f"first_path_index: median {middle:.1f}, but the CIR has {width} samples: probably "
            "counted from the accumulator's first sample, and the CIR is a window of it; expected "
            "a column that is counted from the window's first sample"
        )


def _width(frame: pd.DataFrame) -> int:
    """Return the number of samples of a CIR, those of the accumulator without one."""
    lengths = cir_lengths(frame["cir"]) if "cir" in frame else np.zeros(1, np.int64)
    return int(lengths.max()) if lengths.any() else ACCUMULATOR_SAMPLES


def _dates(frame: pd.DataFrame) -> Iterator[str]:
    """Yield times that are dates."""
    cells = frame["time_s"].dropna() if "time_s" in frame else pd.Series(dtype=object)
    if len(cells) and ISO.match(str(cells.iloc[0])):
        yield f"time_s holds dates such as {cells.iloc[0]!s}: --map time=COLUMN:date"


def _unread_cir(frame: pd.DataFrame) -> Iterator[str]:
    """Yield text columns that hold many numbers in a cell, where no CIR is known."""
    for column in [] if "cir" in frame else frame.columns:
        cells = frame[column].dropna().head(3)
        if len(cells) and all(isinstance(one, str) for one in cells):
            count = min(len(NUMBER.findall(one)) for one in cells)
            if count >= MANY and not any(LETTER.search(one) for one in cells):
                yield (
                    f"column {column!r} holds {count} numbers in a cell, and there is no CIR: "
                    f"--map cir={column} if it is one"
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
