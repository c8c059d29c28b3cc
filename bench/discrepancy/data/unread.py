"""Columns of a recorded table that the diagnosis cannot use, in words: no column vanishes silently.

A number written as text ("92,3", "92.3 rpm") is a category with too many values to the computer.
Text that names categories (a room, a device) is used, and needs no word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import UNIT_AT_END
from bench.discrepancy.data.settings import MOSTLY_NUMBERS, SHOWN_CELL
from bench.discrepancy.settings import MOST_CATEGORIES
from bench.physics.scene import OBSTACLE_LISTS
from bench.recordings.table import CIR_COLUMNS, STRING_COLUMNS

UNITS = (
    r"m/s|km/h|m/s2|[mkc]?m|[mun]?s|µs|min|h|°|deg|rad|°?[ck]|m?v|m?a|k?w|db|dbm|ppm|[kmg]?hz|rpm|"
    r"1/min|%|h?pa|kpa|m?bar|k?g|k?n|t"
)
WRITTEN = re.compile(rf"[-+−]?(\d+(?P<mark>[.,]\d+)?)(e[-+]?\d+)?\s*(?P<unit>{UNITS})?", re.I)
LISTS = {*CIR_COLUMNS, "obstacles", *OBSTACLE_LISTS}  # whose cells are no single value


def unread_words(frame: pd.DataFrame, named: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return a line per column that is not used as it was meant: what it holds, what is expected.

    `named` are columns of which something else is said. Empty columns share a line.
    """
    names = [name for name in map(str, frame.columns) if name not in named]
    empty = [name for name in names if not frame[name].notna().any()]
    rest = [name for name in names if name not in {*empty, *LISTS, *STRING_COLUMNS}]
    lines = [line for name in rest for line in _line(name, frame[name].dropna())]
    if empty:
        many = "s" if len(empty) > 1 else ""
        lines.append(f"column{many} {', '.join(empty)}: no value in any recorded row; not used")
    return tuple(lines)


def _line(name: str, values: pd.Series) -> Iterator[str]:
    """Yield the line about a column's known values, if there is need for one."""
    if pd.api.types.is_numeric_dtype(values) or pd.api.types.is_bool_dtype(values):
        return
    first = values.iloc[0]
    if isinstance(first, list | tuple | np.ndarray | dict | set):
        yield _words(name, f"a {type(first).__name__} in each cell", "one number")
        return
    count = len(set(map(str, values)))
    group = 1 < count <= MOST_CATEGORIES
    numbers = _as_numbers(name, values, group)
    if numbers or count > MOST_CATEGORIES:
        what = (
            f"{'text' if isinstance(first, str) else type(first).__name__} such as {_cell(first)}"
        )
        what += "" if numbers else f" with {count} values, too many for a category"
        end = "taken as a category" if group else "not used"
        yield _words(name, what, "numbers, with a decimal point and no unit", end)


def _words(name: str, what: str, expected: str, end: str = "not used") -> str:
    """Return the line of a column."""
    return f"column {name}: {what}, expected {expected}; {end}"


def _cell(value: object) -> str:
    """Return the beginning of a cell, in quotation marks."""
    return repr(str(value)[:SHOWN_CELL])


def _as_numbers(name: str, values: pd.Series, group: bool) -> bool:
    """Return whether most cells are numbers written as text, or the name has a unit.

    Whole numbers of few values (`group`) may be names: of rooms, of tags.
    """
    found = [WRITTEN.fullmatch(str(value).strip()) for value in values]
    told = [one for one in found if one and (one["mark"] or one["unit"] or not group)]
    text = any(isinstance(value, str) for value in values)
    return text and bool(UNIT_AT_END.search(name) or len(told) >= MOSTLY_NUMBERS * len(found))
