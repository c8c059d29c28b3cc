"""`--map range=dist_mm:mm,true_range=abstand:cm`: whose column is what, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError, unknown_name
from bench.recordings.logs.units import base_names, converter
from bench.recordings.table import CIR_COLUMNS, FLOAT_COLUMNS, STRING_COLUMNS
from bench.recordings.twr import TIMESTAMPS

NEGATED, DATE = "not", "date"
MOST_NAMED, NEAREST = 30, 8  # columns named in a message: all of so few, else the nearest
_OTHERS = (*STRING_COLUMNS, *CIR_COLUMNS, *TIMESTAMPS, "los", "obstacles", "channel")
_BETWEEN = re.compile(r",(?=\s*\w+\s*=)")
_TRUE = ("1", "1.0", "true", "yes", "los", "ja")
_FALSE = ("0", "0.0", "false", "no", "nlos", "nein")


@dataclass(frozen=True)
class Mapped:
    """One mapping: `column` of the exchange format comes from `source`, in `unit` if not None."""

    column: str
    source: str
    unit: str | None
    text: str

    @property
    def where(self) -> str:
        """How it was said, for messages."""
        return f"--map {self.text}"


def parse_maps(specs: Iterable[str]) -> list[Mapped]:
    """Return the mappings of `NAME=COLUMN[:UNIT],..`, whose names may leave out their unit.

    Raises BenchError for what is no mapping, a name that is none of the exchange format's, an
    unknown unit, and two columns mapped to one.
    """
    found = [_parse(text.strip()) for spec in specs for text in _BETWEEN.split(spec)]
    for one in found:
        rivals = [other.source for other in found if other.column == one.column]
        if len(rivals) > 1:
            raise BenchError(
                f"--map: {rivals[0]!r} and {rivals[1]!r} are both mapped to {one.column}; "
                "expected one column each"
            )
    return found


def _parse(text: str) -> Mapped:
    """Return one mapping. Raises BenchError where it is none."""
    name, equals, rest = (part.strip() for part in text.partition("="))
    if not (name and equals and rest):
        raise BenchError(f"--map {text}: expected NAME=COLUMN or NAME=COLUMN:UNIT")
    bases = base_names()
    column = bases.get(name, name)
    known = {*FLOAT_COLUMNS, *bases.values(), *_OTHERS}
    if column not in known:
        raise unknown_name("column of the exchange format", name, {*bases, *_OTHERS})
    source, colon, unit = rest.rpartition(":")
    if not colon:
        return Mapped(column, rest, None, text)
    mapped = Mapped(column, source.strip(), unit.strip(), text)
    if (mapped.unit, column) not in ((NEGATED, "los"), (DATE, "time_s")):
        converter(column, unit.strip(), mapped.where)
    return mapped


def apply_maps(
    frame: pd.DataFrame, maps: Sequence[Mapped], name: str, decimal: str = "."
) -> pd.DataFrame:
    """Return the table with the mapped columns under their new names, in their units.

    A source used is no longer there under its old name. `cir=COLUMN` also takes COLUMN_0 ..
    COLUMN_N. `name` is the file, for messages; text with that `decimal` mark counts as a number.
    Raises BenchError for a column that is not there, and a new name that the table has already.
    """
    frame = _numbered_cirs(frame, maps)
    maps = [one for one in maps if one.source in frame or not _expanded(frame, one)]
    sources = {one.source for one in maps}
    for one in maps:
        _check(frame, one, sources, name)
    new = {one.column: _values(frame[one.source], one, decimal) for one in maps}
    rest = {str(column): frame[column] for column in frame if column not in sources}
    plain = [c for c in rest if c in FLOAT_COLUMNS or c in base_names().values()]
    rest |= {column: numbers(rest[column], decimal) for column in plain}
    return pd.DataFrame(rest | new, copy=False)


def _numbered_cirs(frame: pd.DataFrame, maps: Iterable[Mapped]) -> pd.DataFrame:
    """Return the table with COLUMN_0 .. of a mapped CIR called cir_0 .. instead."""
    renames: dict[str, str] = {}
    for one in maps:
        if one.column in CIR_COLUMNS and one.source not in frame:
            pattern = re.compile(rf"{re.escape(one.source)}(_?)(\d+)")
            matches = [match for c in frame if (match := pattern.fullmatch(str(c)))]
            renames |= {match[0]: f"{one.column}_{int(match[2])}" for match in matches}
    return frame.rename(columns=renames)


def _expanded(frame: pd.DataFrame, one: Mapped) -> bool:
    """Return whether a mapped CIR has been found as numbered columns."""
    return one.column in CIR_COLUMNS and f"{one.column}_0" in frame


def _check(frame: pd.DataFrame, one: Mapped, sources: set[str], name: str) -> None:
    """Raise BenchError where the source is missing or its new name is taken."""
    if one.source not in frame:
        names = list(map(str, frame.columns))
        close = get_close_matches(one.source, names, n=1, cutoff=0.6)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise BenchError(
            f"{one.where}: no column {one.source!r} in {name}{hint} ({_has(names, one.source)})"
        )
    if one.column in frame and one.column != one.source and one.column not in sources:
        raise BenchError(
            f"{one.where}: {name} has a column {one.column!r} of its own; expected one column each"
        )


def _has(names: Sequence[str], wanted: str) -> str:
    """Return the columns there are in words: all of a narrow table, the nearest of a wide one."""
    if len(names) <= MOST_NAMED:
        return f"it has: {', '.join(names)}"
    near = get_close_matches(wanted, names, n=NEAREST, cutoff=0.0)
    return f"it has {len(names)} columns, the nearest by name: {', '.join(near)}"


def _values(column: pd.Series, one: Mapped, decimal: str) -> pd.Series:
    """Return the values of one mapped column in the exchange format's unit."""
    if one.column in ("los", *_OTHERS):
        return _negated(column, one) if one.unit == NEGATED else column
    if one.unit == DATE:
        return _seconds(column, one)
    found = numbers(column, decimal)
    if one.unit is None or not pd.api.types.is_numeric_dtype(found):
        return found if one.unit is None else _keeping_text(found, one)
    return pd.Series(converter(one.column, one.unit, one.where)(_floats(found)), column.index)


def _seconds(column: pd.Series, one: Mapped) -> pd.Series:
    """Return dates as seconds since the first. Raises BenchError where one is in another form."""
    text = column.astype("str").where(column.notna()).str.strip().str.replace(",", ".")
    dates = pd.to_datetime(text, format="ISO8601", errors="coerce", utc=True)
    strange = column[dates.isna() & column.notna()]
    if len(strange):
        raise BenchError(
            f"{one.where}: {one.source!r} holds {strange.iloc[0]!r}; expected dates such as "
            "2026-03-01 08:00:00.5"
        )
    return (dates - dates.min()).dt.total_seconds()


def _keeping_text(column: pd.Series, one: Mapped) -> pd.Series:
    """Return converted numbers; text among them stays, so that it is counted as such later."""
    parsed = pd.to_numeric(column, errors="coerce")
    converted = converter(one.column, str(one.unit), one.where)(_floats(parsed))
    return pd.Series(converted, column.index).astype(object).where(parsed.notna(), column)


def _floats(column: pd.Series) -> NDArray[np.float64]:
    return column.to_numpy(np.float64, na_value=np.nan)


def numbers(column: pd.Series, decimal: str = ".") -> pd.Series:
    """Return a column as numbers; with text among them it stays text, with points as decimals."""
    if pd.api.types.is_numeric_dtype(column):
        return column
    text = column.astype("str").where(column.notna())
    if decimal == ",":
        text = text.str.strip().str.replace(r"^([+-]?\d+),(\d+)", r"\1.\2", regex=True)
    try:
        return pd.to_numeric(text)
    except (ValueError, TypeError):
        return text


def _negated(column: pd.Series, one: Mapped) -> pd.Series:
    """Return the opposite of a truth column. Raises BenchError where it holds something else."""
    words = column.astype("str").str.strip().str.lower()
    known: Mapping[str, bool] = dict.fromkeys(_TRUE, True) | dict.fromkeys(_FALSE, False)
    strange = ~words.isin(known) & column.notna()
    if strange.any():
        found = column[strange].iloc[0]
        raise BenchError(f"{one.where}: {one.source!r} holds {found!r}; expected true or false")
    return (~words.map(known).astype("boolean")).where(column.notna())
