"""Recordings tables as Parquet: list<float32> columns to and from one array per cell, at speed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.files import atomic_path
from bench.recordings.table import CIR_COLUMNS, RECORDINGS_VERSION, Recordings

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

MAGIC = b"PAR1"
ROW_GROUP = 16384


def write_parquet(recordings: Recordings, path: Path) -> None:
    """Write the table and where it came from, in one step. Raises BenchError where it cannot."""
    table = to_arrow(recordings)
    with atomic_path(path) as scratch, writer(scratch, table.schema) as out:
        out.write_table(table, ROW_GROUP)


def writer(path: Path, schema: pa.Schema) -> pq.ParquetWriter:
    """Return a writer of recordings: text by dictionary, no extremes of CIR samples.

    Numbers hardly repeat, so that a dictionary of them costs time and room.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    strings = (pa.string(), pa.large_string())
    return pq.ParquetWriter(
        path,
        schema,
        compression="zstd",
        use_dictionary=[field.name for field in schema if field.type in strings],
        write_statistics=[name for name in schema.names if name not in CIR_COLUMNS],
        write_page_checksum=True,
    )


def to_arrow(recordings: Recordings) -> pa.Table:
    """Return the recordings as an Arrow table with the exchange format's metadata."""
    import pyarrow as pa

    arrays = {str(name): _to_array(str(name), recordings.frame[name]) for name in recordings.frame}
    return pa.table(arrays).replace_schema_metadata(_metadata(recordings))


def _metadata(recordings: Recordings) -> dict[str, str]:
    """Return the key-value metadata of the exchange format."""
    known = {
        "recordings_version": RECORDINGS_VERSION,
        "source": recordings.source,
        "licence": recordings.licence,
        "simulator": recordings.simulator,
        "seed": None if recordings.seed is None else str(recordings.seed),
        "dropped": json.dumps(dict(recordings.dropped)),
    }
    return {key: value for key, value in known.items() if value is not None}


def _to_array(name: str, column: pd.Series) -> pa.Array:
    """Return one column as Arrow; CIRs as list<float32>."""
    import pyarrow as pa

    if name not in CIR_COLUMNS:
        return pa.Array.from_pandas(column)
    sizes = np.fromiter((len(cell) for cell in column), np.int64, len(column))
    return _lists(np.concatenate([np.empty(0, np.float32), *column], dtype=np.float32), sizes)


def lists(cir: NDArray[np.float32]) -> pa.Array:
    """Return CIRs of one length [n, S] as Arrow's list<float32>, a list per row."""
    rows, samples = cir.shape
    return _lists(np.ascontiguousarray(cir, np.float32).ravel(), np.full(rows, samples, np.int64))


def _lists(values: NDArray[np.float32], sizes: NDArray[np.int64]) -> pa.Array:
    """Return as many `values` as `sizes` say in one list after the other."""
    import pyarrow as pa

    offsets = np.concatenate([[0], np.cumsum(sizes)])
    large = offsets[-1] > np.iinfo(np.int32).max
    kind = pa.LargeListArray if large else pa.ListArray
    offsets = offsets.astype(np.int64 if large else np.int32)
    return kind.from_arrays(offsets, values)


def read_parquet(path: Path) -> tuple[pd.DataFrame, Mapping[str, str]]:
    """Return the table of any recordings Parquet, as it is, and its key-value metadata.

    Raises BenchError where the file is no Parquet, is cut short, or holds a CIR that is no list.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    _check_magic(path)
    try:
        table = pq.read_table(path, partitioning=None, page_checksum_verification=True)
        frame = _to_frame(table, path)
    except (pa.ArrowException, OSError, ValueError, KeyError) as problem:
        raise BenchError(f"{path}: damaged Parquet file: {_first_line(problem)}") from problem
    raw: Mapping[bytes, bytes] = table.schema.metadata or {}
    return frame, {key.decode(errors="replace"): _text(value) for key, value in raw.items()}


def _check_magic(path: Path) -> None:
    """Tell a file that is no Parquet from one that is cut short."""
    with path.open("rb") as file:
        start = file.read(4)
        if start != MAGIC:
            raise BenchError(f"{path}: not a Parquet file (it does not begin with PAR1)")
        size = file.seek(0, 2)
        file.seek(max(0, size - 4))
        if size < 12 or file.read(4) != MAGIC:
            raise BenchError(
                f"{path}: truncated Parquet file (its end is missing); copy or download it again"
            )


def _first_line(problem: BaseException) -> str:
    return (str(problem).splitlines() or [type(problem).__name__])[0]


def _text(value: bytes) -> str:
    return value.decode(errors="replace")


def _to_frame(table: pa.Table, path: Path) -> pd.DataFrame:
    """Return a frame with CIR cells as float32 arrays, views of one buffer per chunk."""
    lists = [name for name in CIR_COLUMNS if name in table.column_names]
    frame: pd.DataFrame = table.drop_columns(lists).to_pandas(ignore_metadata=True)
    cells = {name: _cells(table.column(name), name, path) for name in lists}
    columns = {name: cells[name] if name in cells else frame[name] for name in table.column_names}
    return pd.DataFrame(columns, copy=False)


def _cells(column: pa.ChunkedArray, name: str, path: Path) -> NDArray[Any]:
    """Return an object array with one float32 array per row."""
    import pyarrow as pa

    kind = column.type
    lists = (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)
    if not len(column):
        return np.empty(0, dtype=object)
    if not any(is_kind(kind) for is_kind in lists):
        raise BenchError(f"{path}: column {name!r} holds {kind}; expected lists of numbers")
    cells = np.empty(len(column), dtype=object)
    start = 0
    for chunk in column.chunks:
        cells[start : start + len(chunk)] = _split(chunk)
        start += len(chunk)
    return cells


def _split(chunk: pa.Array) -> list[NDArray[np.float32]]:
    """Return the lists of one Arrow chunk as float32 arrays; a null becomes an empty one."""
    import pyarrow as pa
    import pyarrow.compute as pc

    sizes = pc.fill_null(pc.list_value_length(chunk), 0).to_numpy(zero_copy_only=False)
    values = pc.cast(chunk.flatten(), pa.float32()).to_numpy(zero_copy_only=False)
    if len(sizes) and (sizes == sizes[0]).all():
        return list(values.reshape(len(sizes), sizes[0]))
    return np.split(values, np.cumsum(sizes)[:-1])
