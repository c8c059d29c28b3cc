"""Recordings by data set name, by path, or as a table at hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from bench.errors import BenchError, foreign
from bench.recordings.clean import clean
from bench.recordings.io import read_recordings
from bench.recordings.sources.base import Source, is_path, open_source
from bench.recordings.table import CIR_COLUMNS, Recordings

__all__ = ["Table", "is_path", "open_recordings", "open_source", "read"]
Table = str | Path | pd.DataFrame | Recordings
"""A data set name, a file, rows with units in the column names, or recordings."""


def read(recordings: Table, environment: str | None = None) -> Recordings:
    """Return recordings: a data set by name, a .parquet or .csv file, or a table's usable rows.

    `environment` keeps only its rows. Raises BenchError as `open_recordings` does, for an
    environment that is not there and for a table of which most rows are unusable.

    >>> import pandas as pd
    >>> frame = pd.DataFrame({"range_m": [5.1, 7.0], "true_range_m": [5.0, -1.0]})
    >>> read(frame).errors_m().round(2)
    array([0.1])
    >>> dict(read(frame).dropped)
    {'negative true range': 1}
    """
    whole = _whole(recordings)
    return whole if environment is None else _only(whole, environment)


def _whole(recordings: Table) -> Recordings:
    """Return all rows of a table."""
    if isinstance(recordings, Recordings):
        return recordings
    if isinstance(recordings, pd.DataFrame):
        cleaned = clean(_as_in_a_file(recordings), "the table given")
        return Recordings(cleaned.frame, "the table given", dropped=cleaned.dropped)
    return open_recordings(recordings)[0]


def _as_in_a_file(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table with its CIRs as a file would give them: one float32 array per cell."""
    cirs = [name for name in CIR_COLUMNS if name in frame]
    try:
        return frame.assign(**{name: _cells(frame[name]) for name in cirs})
    except (TypeError, ValueError) as problem:
        raise BenchError(f"the table given: {cirs[0]!r} must hold lists of numbers") from problem


def _cells(column: pd.Series) -> pd.Series:
    """Return lists of numbers as float32 arrays; what is no list as an empty one."""
    cells = np.empty(len(column), dtype=object)
    for row, cell in enumerate(column):
        listed = isinstance(cell, list | tuple | np.ndarray)
        cells[row] = np.asarray(cell if listed else [], np.float32)
    return pd.Series(cells, index=column.index)


def _only(table: Recordings, environment: str) -> Recordings:
    """Return the rows of one environment. Raises BenchError where there is none."""
    table.require("environment")
    rows = np.asarray(table.frame["environment"] == environment, bool)
    if not rows.any():
        have = ", ".join(sorted(map(str, table.frame["environment"].dropna().unique())))
        raise BenchError(f"{table.at}: no environment {environment!r} (it has: {have})")
    return table.select(rows)


def open_recordings(name_or_path: str | Path) -> tuple[Recordings, Source | None]:
    """Return the recordings of a data set name, or of a .parquet or .csv file (then no source).

    Raises BenchError: unknown name (with a did-you-mean), missing or damaged file, or a data set
    that is not on this machine (saying what to download and where to put it).
    """
    if is_path(name_or_path):
        return replace(read_recordings(Path(name_or_path)), file=str(name_or_path)), None
    source = open_source(str(name_or_path))
    with foreign(f"data set {name_or_path!r}"):
        missing = source.available()
        if missing is not None:
            raise BenchError(f"data set {source.name!r} is not here: {missing}")
        return source.load(), source
