"""Reading and writing recordings files: Parquet, the exchange format, and CSV.

>>> from pathlib import Path
>>> import pandas as pd
>>> from bench.recordings import Recordings
>>> frame = pd.DataFrame({"range_m": [5.1], "true_range_m": [5.0]})
>>> write_recordings(Recordings(frame, source="mine"), Path("mine.parquet"))  # doctest: +SKIP
>>> len(read_recordings("mine.parquet"))  # doctest: +SKIP
1
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path

from bench.errors import BenchError
from bench.files import is_regular
from bench.recordings.clean import add_counts, clean
from bench.recordings.csv_table import read_csv
from bench.recordings.parquet import read_parquet, write_parquet
from bench.recordings.table import RECORDINGS_VERSION, Recordings

PARQUET_SUFFIXES = (".parquet", ".pq")
CSV_SUFFIXES = (".csv", ".csv.gz")


def write_recordings(recordings: Recordings, path: str | Path) -> None:
    """Write recordings as Parquet with where they came from in the key-value metadata.

    Raises BenchError where the name does not end in .parquet or the file cannot be written;
    nothing is left behind then.
    """
    path = Path(path)
    if path.suffix not in PARQUET_SUFFIXES:
        raise BenchError(f"{path}: recordings are written as Parquet; expected a .parquet name")
    write_parquet(recordings, path)


def read_recordings(path: str | Path) -> Recordings:
    """Read a recordings Parquet or CSV and drop, and count, the bad rows.

    `dropped` adds what was dropped when the file was made (its metadata) to what is dropped now.
    Raises BenchError for a missing, damaged or empty file, a missing column, or mostly bad rows.
    """
    path = Path(path)
    _check_file(path)
    if path.name.endswith(CSV_SUFFIXES):
        frame, metadata = read_csv(path), dict[str, str]()
    else:
        frame, found = read_parquet(path)
        metadata = dict(found)
    _check_version(path, metadata)
    cleaned = clean(frame, str(path))
    return Recordings(
        cleaned.frame,
        source=metadata.get("source", path.stem),
        licence=metadata.get("licence", "unknown"),
        simulator=metadata.get("simulator"),
        seed=_seed(metadata),
        dropped=add_counts(_dropped(metadata), cleaned.dropped),
    )


def _check_file(path: Path) -> None:
    """Raise BenchError where the path is not a readable file of a known kind."""
    if not os.path.lexists(path):
        raise BenchError(f"{path}: no such file")
    if not is_regular(path):
        raise BenchError(f"{path}: not a regular file; expected a recordings .parquet or .csv")
    if not path.name.endswith((*PARQUET_SUFFIXES, *CSV_SUFFIXES)):
        raise BenchError(f"{path}: unknown kind of file; expected .parquet or .csv")
    try:
        path.open("rb").close()
    except OSError as problem:
        raise BenchError(f"{path}: cannot be read: {problem.strerror}") from problem


def _check_version(path: Path, metadata: Mapping[str, str]) -> None:
    """Raise BenchError where the file is of a later version of the exchange format."""
    version = metadata.get("recordings_version", RECORDINGS_VERSION)
    if version != RECORDINGS_VERSION:
        raise BenchError(
            f"{path}: recordings_version {version!r}; this program reads {RECORDINGS_VERSION!r}"
        )


def _seed(metadata: Mapping[str, str]) -> int | None:
    try:
        return int(metadata["seed"])
    except (KeyError, ValueError):
        return None


def _dropped(metadata: Mapping[str, str]) -> dict[str, int]:
    """Return the counts written when the file was made; none where there are no valid ones."""
    try:
        counts = json.loads(metadata.get("dropped", "{}"))
        return {str(reason): int(count) for reason, count in counts.items()}
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        return {}
