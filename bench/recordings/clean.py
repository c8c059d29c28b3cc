"""What a reader does with bad rows: drop, count by reason, never repair silently.

A table without `true_range_m` and `error_m` has the distances between its antennas' positions for
truth. The rules, in this order. A row is dropped, and counted under the reason in quotes, where

- a known float column holds text ("COLUMN is not a number"), or any column an infinity ("COLUMN is
  infinite"); an empty value there only means "not known";
- a count or a spread is negative ("COLUMN is negative");
- a level is beyond 1000 dB of either sign ("COLUMN is no level");
- no error can be had: `error_m`, or `range_m` and `true_range_m`, is missing ("no range error");
- |error| > 1 km and no six exchange timestamps `T1`..`T6` explain it ("error beyond 1 km");
- the true range is negative ("negative true range");
- `error_m` contradicts `range_m - true_range_m` by more than 1 cm ("error_m contradicts ...");
- the table has links but the row has none ("no link");
- the CIR is missing, not of the table's usual (most frequent) length, has a NaN or an infinity, or
  is zero throughout;
- the first path lies outside the CIR ("first path outside the CIR").

Columns of row numbers that pandas wrote along are no columns of the table's.

An empty table, a missing required column, more than half the rows dropped, and ranges that no UWB
radio reaches (millimetres taken for metres) are errors.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.obstacle_names import parse_names
from bench.recordings.places import POSITIONS, distance_m
from bench.recordings.table import CIR_COLUMNS, FLOAT_COLUMNS, STRING_COLUMNS

CHUNK_ROWS = 8192
MAX_ERROR_M = 1000.0
MAX_LEVEL_DB = 1000.0  # no two powers that an instrument measures are so far apart
LEVEL_COLUMNS = ("rx_power_dbm", "first_path_power_dbm")
NEGATIVE = "negative true range"
NO_NUMBER = "is not a number"
HINTS = {  # by how reasons end
    "error beyond 1 km": "; are range_m and true_range_m both in metres?",
    NO_NUMBER: "; expected a decimal point, not a comma, no unit, and nothing where it is unknown",
}
CONTRADICTION_M = 0.01
FARTHEST_M = 1000.0  # the radios' makers promise some 300 m in the open
FAR_QUANTILE = 0.95  # a few wild rows are no table in millimetres
NOT_NEGATIVE = ("preamble_count", "noise_std")
TIMESTAMP_COLUMNS = ("T1", "T2", "T3", "T4", "T5", "T6")
INDEX = re.compile(r"(__index_level_\d+__|Unnamed: \d+)$")  # row numbers that pandas wrote along
Mask = NDArray[np.bool_]
Finding = tuple[str, Mask]

TRUTHS = dict.fromkeys(("true", "1", "1.0", "yes", "los", "ja"), True)
TRUTHS |= dict.fromkeys(("false", "0", "0.0", "no", "nlos", "nein"), False)


@dataclass(frozen=True)
class Cleaned:
    """A table with the column types of the exchange format, and what was dropped by reason."""

    frame: pd.DataFrame
    dropped: Mapping[str, int]


def clean(frame: pd.DataFrame, name: str) -> Cleaned:
    """Return the usable rows of a table in the exchange format's types.

    `name` is the file or data set, for messages. Raises BenchError for an empty table, a missing
    required column, and where more than half the rows are unusable.
    """
    _require(frame, name)
    frame = frame.drop(columns=[one for one in frame if INDEX.match(str(one))])
    frame, text_as_number = _typed(frame.reset_index(drop=True), name)
    dropped: dict[str, int] = {}
    keep = np.ones(len(frame), np.bool_)
    for reason, bad in _findings(frame, text_as_number):
        if count := int((bad & keep).sum()):
            dropped[reason] = count
            keep &= ~bad
    refuse_if_mostly_bad(name, len(frame), dropped)
    _refuse_millimetres(frame[keep], name)
    if not keep.all():
        frame = frame.iloc[np.flatnonzero(keep)].reset_index(drop=True)
    return Cleaned(frame, dropped)


def refuse_if_mostly_bad(name: str, rows: int, dropped: Mapping[str, int]) -> None:
    """Raise BenchError, with the reasons, where more than half of `rows` were dropped."""
    lost = sum(dropped.values())
    if 2 * lost > rows:
        most = max(dropped, key=dropped.__getitem__)
        hint = next((words for reason, words in HINTS.items() if most.endswith(reason)), "")
        raise BenchError(
            f"{name}: {lost} of {rows} rows are unusable ({describe(dropped)}); "
            f"at least half must be usable{hint}"
        )


def describe(dropped: Mapping[str, int]) -> str:
    """Return counts by reason as text, the most frequent first; empty where nothing is dropped."""
    ordered = sorted(dropped.items(), key=lambda item: -item[1])
    return ", ".join(f"{count} {reason}" for reason, count in ordered)


def add_counts(*counts: Mapping[str, int]) -> dict[str, int]:
    """Return several counts by reason added up."""
    total: dict[str, int] = {}
    for some in counts:
        for reason, count in some.items():
            total[reason] = total.get(reason, 0) + count
    return total


def _require(frame: pd.DataFrame, name: str) -> None:
    """Raise BenchError for an empty table, or one from which no error can be computed."""
    if not len(frame):
        raise BenchError(f"{name}: the table has no rows; expected one row per range measurement")
    if "error_m" in frame:
        return
    if "range_m" in frame and set(POSITIONS) <= set(frame.columns):
        return
    for column in ("range_m", "true_range_m"):
        if column not in frame:
            have = ", ".join(map(str, frame.columns))
            raise BenchError(
                f"{name}: no column {column!r}; expected 'range_m' and 'true_range_m' (metres), "
                f"or positions tx_x_m .. rx_z_m for the latter, or 'error_m' (it has: {have})"
            )


def _typed(frame: pd.DataFrame, name: str) -> tuple[pd.DataFrame, dict[str, Mask]]:
    """Return the table in the exchange types, and where text stood in a float column."""
    columns = {str(column): frame[column] for column in frame.columns}
    text: dict[str, Mask] = {}
    for column in [c for c in FLOAT_COLUMNS if c in columns]:
        if pd.api.types.is_bool_dtype(columns[column]):
            raise BenchError(f"{name}: column {column!r} holds true or false; expected numbers")
        if pd.api.types.is_datetime64_any_dtype(columns[column]):
            raise BenchError(
                f"{name}: column {column!r} holds dates (the first: {frame[column].iloc[0]}); "
                "expected numbers, times in seconds from whatever begin"
            )
        columns[column], text[column] = _as_float(columns[column])
        if column in ("error_m", "range_m", "true_range_m") and columns[column].isna().all():
            raise BenchError(f"{name}: column {column!r} holds no number{_first(frame[column])}")
    for column in [c for c in STRING_COLUMNS if c in columns]:
        columns[column] = _as_text(columns[column])
    if "los" in columns:
        columns["los"] = _as_bool(columns["los"], name)
    if "obstacles" in columns:
        columns["obstacles"] = _as_names(columns["obstacles"])
    _add_magnitude(columns)
    _add_truth(columns)
    return pd.DataFrame(columns, copy=False), text


def _first(column: pd.Series) -> str:
    """Return what is expected of a length, beside the first cell that is not empty."""
    cells = column.dropna()
    shown = f" (the first: {str(cells.iloc[0])[:40]!r})" if len(cells) else ""
    return f"{shown}; expected metres, without units or marks between thousands"


def _as_float(column: pd.Series) -> tuple[pd.Series, Mask]:
    """Return a float64 column, and a mask of the values that were there but are no number."""
    if pd.api.types.is_numeric_dtype(column):
        return column.astype(np.float64), np.zeros(len(column), np.bool_)
    numbers = pd.to_numeric(column, errors="coerce").astype(np.float64)
    empty = column.isna() | column.astype("str").str.strip().str.lower().isin(["", "nan"])
    return numbers, np.asarray(numbers.isna() & ~empty)


def _as_text(column: pd.Series) -> pd.Series:
    """Return a string column; whole numbers lose the .0 that a missing value gave them."""
    if pd.api.types.is_float_dtype(column) and (column.dropna() % 1 == 0).all():
        column = column.astype("Int64")
    return column.astype("str").where(column.notna())


def _as_bool(column: pd.Series, name: str) -> pd.Series:
    """Return `los` as bool, or as nullable boolean where some values are not known."""
    if not pd.api.types.is_bool_dtype(column):
        words = column.astype("str").str.strip().str.lower()
        known = words.map(TRUTHS)
        strange = known.isna() & column.notna() & ~words.isin(["", "nan", "none", "<na>"])
        if strange.any():
            raise BenchError(
                f"{name}: column 'los' holds {str(column[strange].iloc[0])[:40]!r}; "
                "expected true or false"
            )
        column = known.astype("boolean")
    return column.astype("boolean" if column.isna().any() else np.bool_)


def _as_names(column: pd.Series) -> pd.Series:
    """Return `obstacles` as one plain list of names per row, of text too; empty = nothing."""
    cells = [
        list(map(str, cell)) if isinstance(cell, list | tuple | np.ndarray) else parse_names(cell)
        for cell in column
    ]
    return pd.Series(cells, index=column.index, dtype=object)


def _add_magnitude(columns: dict[str, pd.Series]) -> None:
    """Give a table that has only the complex accumulator its magnitude column."""
    if "cir" in columns or not {"cir_i", "cir_q"} <= set(columns):
        return
    pairs = zip(columns["cir_i"], columns["cir_q"], strict=True)
    cells = [np.hypot(i, q) if len(i) == len(q) else np.empty(0, np.float32) for i, q in pairs]
    columns["cir"] = _cells(cells, columns["cir_i"].index)


def _add_truth(columns: dict[str, pd.Series]) -> None:
    """Give a table without true ranges the distances between its antennas' positions."""
    if not {"true_range_m", "error_m"} & set(columns) and set(POSITIONS) <= set(columns):
        frame = pd.DataFrame({one: columns[one] for one in POSITIONS})
        columns["true_range_m"] = pd.Series(distance_m(frame), frame.index)


def _cells(cells: list[NDArray[np.float32]], index: pd.Index) -> pd.Series:
    """Return arrays as an object column, one array per cell."""
    column = np.empty(len(cells), dtype=object)
    column[:] = cells
    return pd.Series(column, index=index)


def _findings(frame: pd.DataFrame, text: Mapping[str, Mask]) -> Iterator[Finding]:
    """Yield (reason, bad rows) in the order of the rules."""
    for column, mask in text.items():
        yield f"{column} {NO_NUMBER}", mask
        yield f"{column} is infinite", np.isinf(frame[column].to_numpy())
    for column in _own_floats(frame, text):
        yield f"{column} is infinite", np.isinf(frame[column].to_numpy())
    for column in [c for c in NOT_NEGATIVE if c in frame]:
        yield f"{column} is negative", frame[column].to_numpy() < 0
    for column in [c for c in LEVEL_COLUMNS if c in frame]:
        yield f"{column} is no level", np.abs(frame[column].to_numpy()) > MAX_LEVEL_DB
    yield from _bad_ranges(frame)
    if "link" in frame:
        yield "no link", frame["link"].isna().to_numpy()
    if "cir" in frame:
        yield from _bad_cirs(frame)


def _own_floats(frame: pd.DataFrame, known: Mapping[str, Mask]) -> list[str]:
    """Return the columns of the user's own that hold floating-point numbers."""
    kinds = {str(name): frame[name].dtype for name in frame if name not in known}
    return [name for name, kind in kinds.items() if isinstance(kind, np.dtype) and kind.kind == "f"]


def _refuse_millimetres(frame: pd.DataFrame, name: str) -> None:
    """Raise BenchError for ranges beyond any UWB radio's reach, unless timestamps explain them."""
    column = "true_range_m" if "true_range_m" in frame else "range_m"
    if column not in frame or _timestamped(frame).any():
        return
    far = frame[column].quantile(FAR_QUANTILE)
    if far > FARTHEST_M:
        raise BenchError(
            f"{name}: {column} reaches {far:.0f}, further than UWB does; expected metres "
            "(are they millimetres?)"
        )


def _bad_ranges(frame: pd.DataFrame) -> Iterator[Finding]:
    """Yield the rows whose range, truth or error is missing or impossible."""
    nothing = np.full(len(frame), np.nan)
    measured = frame["range_m"].to_numpy() if "range_m" in frame else nothing
    true = frame["true_range_m"].to_numpy() if "true_range_m" in frame else nothing
    with np.errstate(invalid="ignore"):
        difference = measured - true
        error = frame["error_m"].to_numpy() if "error_m" in frame else difference
        yield "no range error", np.isnan(error)
        yield "error beyond 1 km", (np.abs(error) > MAX_ERROR_M) & ~_timestamped(frame)
        yield NEGATIVE, true < 0
        contradicts = np.abs(error - difference) > CONTRADICTION_M
    yield "error_m contradicts range_m - true_range_m", contradicts


def _timestamped(frame: pd.DataFrame) -> Mask:
    """Return where all six timestamps of the exchange are known."""
    if not set(TIMESTAMP_COLUMNS) <= set(frame.columns):
        return np.zeros(len(frame), np.bool_)
    return np.asarray(frame[list(TIMESTAMP_COLUMNS)].notna().all(axis=1))


def _bad_cirs(frame: pd.DataFrame) -> Iterator[Finding]:
    """Yield the rows whose CIR or first path cannot be used."""
    lengths = cir_lengths(frame["cir"])
    yield "no CIR", lengths == 0
    usual = int(np.bincount(lengths[lengths > 0]).argmax()) if lengths.any() else 0
    wrong = (lengths != usual) | (lengths == 0)
    for part in [c for c in CIR_COLUMNS[1:] if c in frame]:
        wrong |= cir_lengths(frame[part]) != usual
    yield f"CIR not of length {usual}", wrong
    not_finite, silent = _cir_faults(frame["cir"], wrong)
    yield "NaN in the CIR", not_finite
    yield "CIR zero throughout", silent
    if "first_path_index" in frame:
        index = frame["first_path_index"].to_numpy()
        yield "first path outside the CIR", (index < 0) | (index >= usual)


def cir_lengths(column: pd.Series) -> NDArray[np.int64]:
    """Return the number of samples in each CIR cell, 0 where there is none."""
    sizes = (len(cell) if isinstance(cell, np.ndarray) else 0 for cell in column)
    return np.fromiter(sizes, np.int64, len(column))


def _cir_faults(column: pd.Series, wrong: Mask) -> tuple[Mask, Mask]:
    """Return where a CIR of the right length has a NaN or infinity, and where it is all zero."""
    not_finite, silent = np.zeros((2, len(column)), np.bool_)
    rows = np.flatnonzero(~wrong)
    for start in range(0, len(rows), CHUNK_ROWS):
        chunk = rows[start : start + CHUNK_ROWS]
        cirs = np.stack(list(column.iloc[chunk]))
        peaks = np.abs(cirs).max(axis=1)
        not_finite[chunk] = ~np.isfinite(peaks)
        silent[chunk] = peaks == 0
    return not_finite, silent
