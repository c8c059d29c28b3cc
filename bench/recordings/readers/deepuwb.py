"""Deep UWB data set (Angarano et al. 2021): the data of the REMnet paper.

Zenodo 10.5281/zenodo.4290069, "Robust Ultra-wideband Range Error Mitigation with Deep Learning at
the Edge". EVB1000 boards, truth from a laser tracker. One pandas pickle `dataset.pkl` with about
55 000 rows: `CIR` (157 values: 5 before the detected first path, 152 from it on), `Error` (metres,
measured - true), `Room` (0 through the wall, 1 big, 2 medium, 3 small, 4 outdoor) and `Obstacles`
(ten digits 0/1, one per kind). The pickle is read without running anything in it (`pickled`).

- Only the error is published: there is no `range_m` and no `true_range_m`.
- `first_path_index` = 5, as published. `los` = no obstacle.
- `link` is DERIVED, since none is published: rows were taken along paths with anchor and obstacles
  left alone, so each unbroken run of rows with the same room and obstacles is taken as one link.
  Where such runs are shorter than 20 rows on average the rows are not in the order they were taken,
  and all rows with the same room and obstacles are one link.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.clean import Cleaned, add_counts, clean, refuse_if_mostly_bad
from bench.recordings.readers.pickled import read_pickled_frame
from bench.recordings.table import SAMPLE_PERIOD_NS

SAMPLES = 157
SAMPLES_BEFORE = 5
MEAN_RUN_ROWS = 20
ROOMS = {0: "through-the-wall", 1: "big", 2: "medium", 3: "small", 4: "outdoor"}
OBSTACLES = (
    "wall", "polystyrene plate", "plastic", "plywood plate", "cardboard box", "LCD TV",
    "metal plate", "wood door", "glass plate", "metal window",
)  # fmt: skip
COLUMNS = ("CIR", "Error", "Room", "Obstacles")
MODULES = (__name__, "bench.recordings.readers.pickled", "bench.recordings.clean")


def read_deepuwb(path: Path) -> Cleaned:
    """Return the rows of the published pickle.

    Raises BenchError where it is cut short, hostile or of another form.
    """
    columns = read_pickled_frame(path)
    for name in COLUMNS:
        if name not in columns:
            raise BenchError(f"{path}: no column {name!r} (it has: {', '.join(columns)})")
    frame, dropped = _exchange_format(columns, str(path))
    cleaned = clean(frame, str(path))
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def _exchange_format(
    columns: dict[str, NDArray[Any]], name: str
) -> tuple[pd.DataFrame, dict[str, int]]:
    """Return the rows in the exchange format, and how many have no valid room or obstacles."""
    rooms = pd.Series(columns["Room"]).map(ROOMS)
    digits = pd.Series([_digits(cell) for cell in columns["Obstacles"]], dtype=object)
    lengths = np.array([np.size(cell) for cell in columns["CIR"]])
    bad = {
        "unknown room": rooms.isna().to_numpy(),
        "obstacles are not ten digits 0/1": (rooms.notna() & digits.isna()).to_numpy(),
        f"CIR not of length {SAMPLES}": rooms.notna() & digits.notna() & (lengths != SAMPLES),
    }
    dropped = {reason: int(rows.sum()) for reason, rows in bad.items() if rows.any()}
    refuse_if_mostly_bad(name, len(rooms), dropped)
    keep = np.flatnonzero(~np.logical_or.reduce([np.asarray(rows) for rows in bad.values()]))
    obstacles = [_names(digits[row]) for row in keep]
    table = {
        "error_m": [_number(columns["Error"][row]) for row in keep],
        "cir": [np.asarray(columns["CIR"][row], np.float32).ravel() for row in keep],
        "first_path_index": float(SAMPLES_BEFORE),
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "los": [not found for found in obstacles],
        "environment": rooms.to_numpy()[keep],
        "obstacles": obstacles,
        "link": _links(rooms.to_numpy()[keep], digits.to_numpy()[keep]),
    }
    return pd.DataFrame(table), dropped


def _digits(cell: Any) -> str | None:
    """Return ten digits 0/1, whether published as text or as ten values; None where neither."""
    if not isinstance(cell, str):
        try:
            cell = "".join(str(int(bit)) for bit in np.asarray(cell).ravel())
        except (TypeError, ValueError):
            return None
    return cell if len(cell) == len(OBSTACLES) and set(cell) <= {"0", "1"} else None


def _names(digits: str) -> list[str]:
    """Return the names of the obstacles that the digits mark."""
    return [name for name, digit in zip(OBSTACLES, digits, strict=True) if digit == "1"]


def _number(cell: Any) -> float:
    """Return the one number of a cell; NaN where it holds none."""
    try:
        return float(np.asarray(cell, np.float64).item())
    except (TypeError, ValueError):
        return float("nan")


def _links(rooms: NDArray[Any], digits: NDArray[Any]) -> list[str]:
    """Return a derived link per row: its run of equal room and obstacles, or just those."""
    kinds = [f"{room} {bits}" for room, bits in zip(rooms, digits, strict=True)]
    changes = [True, *(one != following for one, following in pairwise(kinds))]
    runs = np.cumsum(changes[: len(kinds)])
    if not len(runs) or len(runs) < MEAN_RUN_ROWS * runs[-1]:
        return kinds
    return [f"{kind} run {run}" for kind, run in zip(kinds, runs, strict=True)]
