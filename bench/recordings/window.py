"""Cutting the same stretch of every CIR: so many samples before the first path, so many after."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.clean import cir_lengths, refuse_if_mostly_bad
from bench.recordings.table import Recordings

BEFORE = 5
AFTER = 152
CHUNK_ROWS = 8192


@dataclass(frozen=True)
class CirWindow:
    """CIR magnitudes float32 [n, before + after] around the first path, and whose they are.

    `rows` are the positions [n] in the recordings table, ascending: `recordings.select(rows)` goes
    with `cirs` row by row. `dropped` counts the rows without such a window, by reason.
    """

    cirs: NDArray[np.float32]
    rows: NDArray[np.intp]
    dropped: Mapping[str, int]


def cir_window(recordings: Recordings, before: int = BEFORE, after: int = AFTER) -> CirWindow:
    """Cut `before` samples before each row's detected first path and `after` from it on.

    The first path is the sample floor(first_path_index), so the window is
    `cir[floor(first_path_index) - before : floor(first_path_index) + after]`; the default is the
    form of the Deep UWB data set (157 samples, the first path at position 5). A row whose CIR does
    not reach that far on either side, or whose first path is not known, is dropped and counted.
    Without a `first_path_index` column the CIR must be exactly `before + after` samples long and
    is taken as already cut.

    Raises BenchError where there is no CIR, where it is not cut and cannot be, and where more than
    half the rows have no such window.
    """
    recordings.require("cir")
    column = recordings.frame["cir"]
    lengths = cir_lengths(column)
    if "first_path_index" not in recordings.frame:
        starts = _already_cut(recordings.source, lengths, before + after)
        known = np.ones(len(column), np.bool_)
    else:
        index = recordings.frame["first_path_index"].to_numpy(np.float64)
        known = np.isfinite(index)
        starts = np.floor(np.where(known, index, 0.0)).astype(np.int64) - before
    early = known & (starts < 0)
    short = known & ~early & (starts + before + after > lengths)
    dropped = _count(
        {
            "first path not known": ~known,
            f"fewer than {before} CIR samples before the first path": early,
            f"fewer than {after} CIR samples from the first path on": short,
        }
    )
    refuse_if_mostly_bad(recordings.source, len(column), dropped)
    rows = np.flatnonzero(known & ~early & ~short)
    return CirWindow(_cut(column, rows, starts, before + after), rows, dropped)


def _already_cut(source: str, lengths: NDArray[np.int64], width: int) -> NDArray[np.int64]:
    """Return starts of 0. Raises BenchError where a CIR is not exactly `width` samples long."""
    wrong = lengths[lengths != width]
    if len(wrong):
        raise BenchError(
            f"{source}: the CIR has {wrong[0]} samples and there is no column 'first_path_index' "
            f"to cut it by; expected that column, or CIRs of exactly {width} samples"
        )
    return np.zeros(len(lengths), np.int64)


def _count(masks: Mapping[str, NDArray[np.bool_]]) -> dict[str, int]:
    """Return how many rows each mask marks, leaving out the empty ones."""
    return {reason: int(mask.sum()) for reason, mask in masks.items() if mask.any()}


def _cut(
    column: pd.Series, rows: NDArray[np.intp], starts: NDArray[np.int64], width: int
) -> NDArray[np.float32]:
    """Return the windows [len(rows), width] of the named rows."""
    cirs = np.empty((len(rows), width), np.float32)
    cells = column.to_numpy()
    for where, same_length in _same_length_chunks(cells, rows):
        index = starts[rows[where], None] + np.arange(width)
        cirs[where] = np.take_along_axis(np.stack(list(same_length)), index, axis=1)
    return cirs


def _same_length_chunks(
    cells: NDArray[np.object_], rows: NDArray[np.intp]
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.object_]]]:
    """Yield (positions in `rows`, their CIRs) in chunks of CIRs of one length."""
    lengths = np.fromiter((len(cell) for cell in cells[rows]), np.int64, len(rows))
    for length in np.unique(lengths):
        places = np.flatnonzero(lengths == length)
        for start in range(0, len(places), CHUNK_ROWS):
            where = places[start : start + CHUNK_ROWS]
            yield where, cells[rows[where]]
