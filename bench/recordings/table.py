"""The recordings table: the one exchange format every part speaks.

One row is one range measurement; units stand in the column names. A column that is not known is
absent, a value that is not known is null, unknown columns are kept.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError

RECORDINGS_VERSION = "1"
SAMPLE_PERIOD_NS = 1.0016  # DW1000 accumulator: 1 / (2 x 499.2 MHz)

FLOAT_COLUMNS = (
    "range_m",
    "true_range_m",
    "error_m",
    "first_path_index",
    "sample_period_ns",
    "rx_power_dbm",
    "first_path_power_dbm",
    "noise_std",
    "preamble_count",
    "cir_power",
    "fp_ampl1",
    "fp_ampl2",
    "fp_ampl3",
    "tx_x_m",
    "tx_y_m",
    "tx_z_m",
    "rx_x_m",
    "rx_y_m",
    "rx_z_m",
    "time_s",
    "reply_time_s",
    "clock_offset_ppm",
    "temperature_c",
    "azimuth_deg",
)
STRING_COLUMNS = ("environment", "link", "tx", "rx")
CIR_COLUMNS = ("cir", "cir_i", "cir_q")


@dataclass(frozen=True)
class Recordings:
    """A recordings table with where it came from.

    `frame` holds one row per range (columns of RECORDINGS: `range_m`, `cir`, `link`, ...); `cir`
    cells are float32 arrays. `dropped` counts the rows a reader left out, by reason. `simulator`
    is the TOML text that made a simulated table, None for real recordings. `file` is the one
    that a user named, "" where none.
    """

    frame: pd.DataFrame
    source: str
    licence: str = "unknown"
    simulator: str | None = None
    seed: int | None = None
    dropped: Mapping[str, int] = field(default_factory=dict)
    file: str = ""

    def __len__(self) -> int:
        return len(self.frame)

    @property
    def simulated(self) -> bool:
        """True where a simulator made the rows."""
        return self.simulator is not None

    @property
    def label(self) -> str:
        """The source, marked SIMULATED where it is."""
        return f"{self.source} (SIMULATED)" if self.simulated else self.source

    @property
    def at(self) -> str:
        """Where a mistake in it is to be looked for: the file, or the source of what is in none."""
        return self.file or self.source

    def errors_m(self) -> NDArray[np.float64]:
        """Return measured - true range [n] in metres. Raises BenchError where neither is known."""
        if "error_m" in self.frame:
            return np.asarray(self.frame["error_m"], np.float64)
        self.require("range_m", "true_range_m")
        measured = np.asarray(self.frame["range_m"], np.float64)
        return measured - np.asarray(self.frame["true_range_m"], np.float64)

    def require(self, *columns: str) -> None:
        """Raise BenchError naming the first of `columns` the table does not have."""
        for column in columns:
            if column not in self.frame:
                have = ", ".join(map(str, self.frame.columns))
                raise BenchError(f"{self.at}: no column {column!r} (it has: {have})")

    def select(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Recordings:
        """Return the recordings of some rows, by mask or position."""
        keep = np.flatnonzero(rows) if rows.dtype == np.bool_ else rows
        return replace(self, frame=self.frame.iloc[keep].reset_index(drop=True))

    @cached_property
    def fingerprint(self) -> str:
        """16 hex digits that change with any value, column or row order of the table."""
        digest = hashlib.sha256()
        for column in sorted(map(str, self.frame.columns)):
            digest.update(column.encode())
            digest.update(_column_bytes(self.frame[column]))
        return digest.hexdigest()[:16]


def _column_bytes(column: pd.Series) -> bytes:
    """Return bytes that determine a column's values."""
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_extension_array_dtype(column):
        return np.ascontiguousarray(column.to_numpy()).tobytes()
    if len(column) and all(isinstance(value, np.ndarray) for value in column):
        lengths = np.array([len(value) for value in column], np.int64)
        return lengths.tobytes() + np.concatenate(list(column)).tobytes()
    return "\x1f".join(map(_cell_text, column.tolist())).encode()


def _cell_text(cell: object) -> str:
    """Return text that determines one cell; the repr of a long array leaves its middle out."""
    if isinstance(cell, np.ndarray):
        return f"{cell.dtype}{cell.shape}{cell.tobytes().hex()}"
    return repr(cell)
