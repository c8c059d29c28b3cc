"""Recordings by data set name or by path."""

from __future__ import annotations

from pathlib import Path

from bench.errors import BenchError
from bench.plugins import find
from bench.recordings.io import read_recordings
from bench.recordings.sources.base import Source
from bench.recordings.table import Recordings


def open_recordings(name_or_path: str | Path) -> tuple[Recordings, Source | None]:
    """Return the recordings of a data set name, or of a .parquet or .csv file (then no source).

    Raises BenchError: unknown name (with a did-you-mean), missing or damaged file, or a data set
    that is not on this machine (saying what to download and where to put it).
    """
    if _is_path(name_or_path):
        return read_recordings(Path(name_or_path)), None
    source = open_source(str(name_or_path))
    missing = source.available()
    if missing is not None:
        raise BenchError(f"data set {source.name!r} is not here: {missing}")
    return source.load(), source


def open_source(name: str) -> Source:
    """Return the data set registered under `name`.

    Raises BenchError for an unknown name (with a did-you-mean) and a plug-in that is no data set.
    """
    plugin = find("datasets", name)
    made = plugin.load()
    source = made() if callable(made) else made
    if not isinstance(source, Source):
        raise BenchError(
            f"data set {name!r} of {plugin.distribution} is no bench.recordings Source "
            f"but {type(source).__name__}"
        )
    return source


def _is_path(name_or_path: str | Path) -> bool:
    """Return whether it is a path: a Path, or anything but a bare word without a dot."""
    path = Path(name_or_path)
    return isinstance(name_or_path, Path) or len(path.parts) != 1 or "." in str(name_or_path)
