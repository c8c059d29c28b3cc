"""Making links: which rows belong to one pair of antenna positions.

`--link A,B,..` joins columns: rows with the same values are one link. `--link-by` adds a rule for
what moves: `time:20s` cuts each of them into stretches of time, `grid:0.5m` into cells of the
antennas' positions (a row belongs to the cells both antennas are in). Without `--link` the rule
starts from `tx` and `rx`, either way round, where the table has them.

A moving pair's rows just before and after a cut are nearly the same geometry: take stretches long
enough that the pair is elsewhere by then.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bench.errors import BenchError
from bench.recordings.logs.mapping import numbers
from bench.recordings.logs.units import converter

RULES = ("time", "grid")
MISSING = (
    "no link: name the columns that tell one pair of antenna positions from another (--link tx,rx) "
    "or cut moving pairs (--link-by time:20s); without links `bench run` cannot split these rows"
)


def make_links(
    frame: pd.DataFrame, columns: Sequence[str], rule: str | None, name: str
) -> pd.Series | None:
    """Return the link of every row, null where a part of it is not known; None where not asked.

    `name` is the file, for messages. Raises BenchError for a column that is not there and a rule
    that is none.
    """
    if not columns and rule is None:
        return None
    parts = [_text(frame, column, name) for column in columns] if columns else _pair(frame)
    if rule is not None:
        parts = [*parts, *_cells(frame, rule, name)]
    known = np.logical_and.reduce([part.notna().to_numpy() for part in parts])
    joined = parts[0].astype("str")
    for part in parts[1:]:
        joined = joined + " | " + part.astype("str")
    return joined.where(known)


def _text(frame: pd.DataFrame, column: str, name: str) -> pd.Series:
    """Return a column as text. Raises BenchError where it is not there."""
    if column not in frame:
        have = ", ".join(map(str, frame.columns))
        raise BenchError(f"--link {column}: no column {column!r} in {name} (it has: {have})")
    return _plain(frame[column])


def _plain(column: pd.Series) -> pd.Series:
    """Return text without the .0 that a missing value gives whole numbers."""
    if pd.api.types.is_float_dtype(column) and (column.dropna() % 1 == 0).all():
        column = column.astype("Int64")
    return column.astype("str").where(column.notna())


def _pair(frame: pd.DataFrame) -> list[pd.Series]:
    """Return tx and rx as one part, the same either way round; nothing where they are not known."""
    if not {"tx", "rx"} <= set(frame.columns):
        return []
    tx, rx = _plain(frame["tx"]), _plain(frame["rx"])
    first, second = tx.where(tx <= rx, rx), rx.where(tx <= rx, tx)
    return [(first.astype("str") + "-" + second.astype("str")).where(tx.notna() & rx.notna())]


def _cells(frame: pd.DataFrame, rule: str, name: str) -> list[pd.Series]:
    """Return the stretch of time or the cells of place. Raises BenchError for another rule."""
    kind, _, size = rule.partition(":")
    if kind not in RULES:
        raise BenchError(f"--link-by {rule}: expected time:DURATION or grid:LENGTH, as in time:20s")
    unit = "s" if kind == "time" else "m"
    width = _size(size, unit, rule)
    wanted = ["time_s"] if kind == "time" else _places(frame)
    for column in wanted or ["tx_x_m"]:
        if column not in frame:
            raise BenchError(f"--link-by {rule}: no column {column!r} in {name}")
    return [_floored(frame[column], width, unit) for column in wanted]


def _places(frame: pd.DataFrame) -> list[str]:
    ends = [f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"]
    return [column for column in ends if column in frame]


def _floored(column: pd.Series, width: float, unit: str) -> pd.Series:
    """Return the lower end of each value's cell as text, such as `20 s`."""
    values = pd.to_numeric(numbers(column), errors="coerce")
    lower: pd.Series = (values // width) * width
    return lower.map(f"{{:g}} {unit}".format).where(values.notna())


def _size(text: str, unit: str, rule: str) -> float:
    """Return `20s` or `0.5m` as a number of the unit; a bare number is in it already."""
    number = text.strip()
    while number and not number[-1].isdigit():
        number = number[:-1]
    try:
        value = np.array([float(number)])
    except ValueError as problem:
        raise BenchError(f"--link-by {rule}: expected a size such as 20{unit}") from problem
    given = text.strip()[len(number) :].strip() or unit
    size = float(converter(f"size_{unit}", given, f"--link-by {rule}")(value)[0])
    if not size > 0:
        raise BenchError(f"--link-by {rule}: expected a size above zero")
    return size
