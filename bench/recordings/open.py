"""Recordings by data set name or by path."""

from __future__ import annotations

from pathlib import Path

from bench.errors import BenchError
from bench.recordings.io import read_recordings
from bench.recordings.sources.base import Source, open_source
from bench.recordings.table import Recordings

__all__ = ["open_recordings", "open_source"]


def open_recordings(name_or_path: str | Path) -> tuple[Recordings, Source | None]:
    """Return the recordings of a data set name, or of a .parquet or .csv file (then no source).

    Raises BenchError: unknown name (with a did-you-mean), missing or damaged file, or a data set
    that is not on this machine (saying what to download and where to put it).
    """
    if is_path(name_or_path):
        return read_recordings(Path(name_or_path)), None
    source = open_source(str(name_or_path))
    missing = source.available()
    if missing is not None:
        raise BenchError(f"data set {source.name!r} is not here: {missing}")
    return source.load(), source


def is_path(name_or_path: str | Path) -> bool:
    """Return whether it is a path: a Path, or anything but a bare word without a dot."""
    path = Path(name_or_path)
    return isinstance(name_or_path, Path) or len(path.parts) != 1 or "." in str(name_or_path)
