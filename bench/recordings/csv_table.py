"""Recordings tables as CSV.

The rule: one header line with the exchange format's column names, one line per range. The CIR
stands either in one cell `cir` - a list such as `[12, 15.5, 9]`, or numbers separated by spaces or
semicolons - or in columns `cir_0`, `cir_1`, .. `cir_N`, numbered from 0 without a gap. `cir_i` and
`cir_q` likewise (`cir_i_0`, ..). `los` is true/false, 1/0 or yes/no. `obstacles` holds names
separated by semicolons, or a JSON list. An empty cell is "not known".
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.obstacle_names import parse_names
from bench.recordings.table import CIR_COLUMNS, STRING_COLUMNS
from bench.text import one_line

PARQUET_BEGINS, GZIP_BEGINS, ZIP_BEGINS = b"PAR1", b"\x1f\x8b", b"PK\x03\x04"
FIRST_BYTES = 1024
OTHER_DELIMITERS = ";\t|"
IMPORT = "bench data import finds its delimiter and decimal mark"
_AS_TEXT = (*STRING_COLUMNS, *CIR_COLUMNS, "obstacles", "los")


def read_csv(path: Path) -> pd.DataFrame:
    """Return the table of a CSV, as it is. Raises BenchError where it is no CSV table."""
    other = not _no_text(path) and _other_delimiter(path)
    try:
        frame = read_text_table(path)
    except BenchError as problem:
        if other:
            raise BenchError(f"{problem}; a log of another form: {IMPORT}") from problem
        raise
    if other and len(frame.columns) == 1:
        raise BenchError(f"{path}: its header has no comma; a log of another form: {IMPORT}")
    return with_lists(frame, path)


def _other_delimiter(path: Path) -> bool:
    """Return whether what a text file begins with is parted by something else than commas."""
    lines = _begins(path).decode(errors="replace").splitlines()
    return any(line.count(",") < max(map(line.count, OTHER_DELIMITERS)) for line in lines[:-1])


def read_text_table(
    path: Path, delimiter: str = ",", decimal: str = ".", encoding: str = "utf-8", skip: int = 0
) -> pd.DataFrame:
    """Return a text table cell by cell, its lists still text.

    `skip` lines stand before the header; fields separated by " " may have several blanks between
    them. Raises BenchError where it is no such table.
    """
    import pyarrow as pa
    from pyarrow import csv

    if words := _no_text(path, encoding):
        raise BenchError(f"{path}: {words}")
    if delimiter == " ":
        return _spaced(path, decimal, encoding, skip)
    options = csv.ConvertOptions(
        column_types=dict.fromkeys(_AS_TEXT, pa.string()),
        strings_can_be_null=True,
        decimal_point=decimal,
    )
    reading = csv.ReadOptions(encoding=encoding, skip_rows=skip)
    parsing = csv.ParseOptions(delimiter=delimiter)
    try:
        table = csv.read_csv(path, reading, parsing, options)
    except (pa.ArrowException, OSError, ValueError) as problem:
        raise BenchError(f"{path}: not a CSV table: {_reason(problem)}") from problem
    frame: pd.DataFrame = table.to_pandas()
    if len(set(frame.columns)) < len(frame.columns):
        twice = frame.columns[frame.columns.duplicated()][0]
        raise BenchError(f"{path}: column {twice!r} stands twice in the header")
    return frame.rename(columns=lambda name: str(name).strip())


def _begins(path: Path) -> bytes:
    """Return the first bytes of a file, none where it cannot be read: the reader says why."""
    try:
        with path.open("rb") as file:
            return file.read(FIRST_BYTES)
    except OSError:
        return b""


def _no_text(path: Path, encoding: str = "utf-8") -> str:
    """Return what a file is that is no text although its name says so, in words; else ""."""
    first = _begins(path)
    if first.startswith(PARQUET_BEGINS):
        return "it is Parquet, not CSV: expected a name that ends in .parquet"
    if first.startswith(GZIP_BEGINS) and path.suffix != ".gz":
        return "it is compressed with gzip, not CSV: expected a name that ends in .csv.gz"
    if first.startswith(ZIP_BEGINS):
        return "it is a zip archive or a spreadsheet (.xlsx), not CSV: unpack it, or save it as CSV"
    wide = encoding.lower().replace("_", "-").startswith(("utf-16", "utf-32"))
    if b"\0" in first and not wide and path.suffix != ".gz":
        return "it is no text (it holds zero bytes), so no CSV; UTF-16 is read by bench data import"
    return ""


def _reason(problem: Exception) -> str:
    """Return why a table could not be read, in one line without bytes that are no text."""
    said = one_line((str(problem).splitlines() or ["unreadable"])[0])
    return said if "\ufffd" not in said else f"{said.partition(': ')[0]}: it holds bytes of no text"


def _spaced(path: Path, decimal: str, encoding: str, skip: int) -> pd.DataFrame:
    """Return a table whose fields are separated by blanks. Raises BenchError where it is none."""
    try:
        return pd.read_csv(path, sep=r"\s+", decimal=decimal, encoding=encoding, skiprows=skip)
    except (OSError, ValueError) as problem:
        raise BenchError(f"{path}: not a table of columns: {_reason(problem)}") from problem


def with_lists(frame: pd.DataFrame, path: Path) -> pd.DataFrame:
    """Return the table with CIRs as arrays and obstacles as lists.

    Raises BenchError naming the file where a numbered CIR column is missing or holds text.
    """
    columns: dict[str, Any] = {}
    taken: set[str] = set()
    for name in CIR_COLUMNS:
        numbered = _numbered(frame, name, path)
        taken.update(numbered)
        if numbered:
            columns[name] = _object([*frame[numbered].to_numpy(np.float32, na_value=np.nan)])
        elif name in frame:
            columns[name] = _object([parse_numbers(cell) for cell in frame[name]])
    if "obstacles" in frame:
        columns["obstacles"] = _object([parse_names(cell) for cell in frame["obstacles"]])
    rest = {str(name): frame[name] for name in frame if name not in taken}
    return pd.DataFrame(rest | columns, copy=False)


def _numbered(frame: pd.DataFrame, name: str, path: Path) -> list[str]:
    """Return the columns NAME_0 .. NAME_N in order. Raises BenchError where one is missing."""
    found = {int(match[1]) for c in frame if (match := re.fullmatch(rf"{name}_(\d+)", str(c)))}
    if missing := sorted(set(range(len(found))) - found):
        raise BenchError(
            f"{path}: no column '{name}_{missing[0]}'; expected {name}_0 to {name}_{max(found)} "
            "without a gap"
        )
    columns = [f"{name}_{number}" for number in sorted(found)]
    for column in columns:
        if not pd.api.types.is_numeric_dtype(frame[column]) and frame[column].notna().any():
            raise BenchError(f"{path}: column {column!r} holds text; expected numbers")
    return columns


def _object(cells: list[Any]) -> NDArray[Any]:
    """Return the cells as an object array, one per row."""
    column = np.empty(len(cells), dtype=object)
    for row, cell in enumerate(cells):
        column[row] = cell
    return column


def parse_numbers(cell: object) -> NDArray[np.float32]:
    """Return the numbers of one CIR cell; an empty array where it holds no list of numbers."""
    text = str(cell).strip("[]() \t") if isinstance(cell, str) else ""
    try:
        return np.array(re.sub("[,;]", " ", text).split(), dtype=np.float32)
    except ValueError:
        return np.empty(0, np.float32)
