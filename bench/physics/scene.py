"""What is known of the rows before anything is simulated: positions, obstacles, settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.physics.units import Floats

_ENDS = tuple(tuple(f"{end}_{axis}_m" for axis in "xyz") for end in ("tx", "rx"))
_LISTS = (
    "obstacles",
    "obstacle_thickness_m",
    "obstacle_at",
    "obstacle_clearance_m",
    "obstacle_far_clearance_m",
    "obstacle_incidence_deg",
)
_HASHED = ("link", "tx", "rx", "environment")


@dataclass(frozen=True)
class Scene:
    """The known columns of n rows as arrays.

    `numbers` holds float64 [n] (NaN = unknown), `lists` float64 [n, M] padded with NaN for the
    obstacle columns, `kinds` the obstacle names [n, M] padded with "", `hashes` uint64 [n] of the
    string columns, for draws that are equal within a link or device.
    """

    numbers: Mapping[str, Floats]
    lists: Mapping[str, Floats]
    kinds: NDArray[np.str_]
    hashes: Mapping[str, NDArray[np.uint64]]
    true_range_m: Floats

    def __len__(self) -> int:
        return len(self.true_range_m)

    def slice(self, start: int, stop: int) -> Scene:
        """Return rows `start` to `stop`."""
        part = slice(start, stop)
        return Scene(
            {name: column[part] for name, column in self.numbers.items()},
            {name: column[part] for name, column in self.lists.items()},
            self.kinds[part],
            {name: column[part] for name, column in self.hashes.items()},
            self.true_range_m[part],
        )

    def has(self, name: str) -> bool:
        """Return whether a numeric column is there at all."""
        return name in self.numbers

    def number(self, name: str, default: float) -> Floats:
        """Return a numeric column [n], `default` where it is absent or unknown."""
        if name not in self.numbers:
            return np.full(len(self), default)
        column = self.numbers[name]
        return np.where(np.isnan(column), default, column)

    def group(self, *names: str) -> NDArray[np.uint64]:
        """Return a hash [n] of the first of these string columns that is there, else zeros."""
        for name in names:
            if name in self.hashes:
                return self.hashes[name]
        return np.zeros(len(self), np.uint64)

    def obstacle(self, name: str, default: float) -> Floats:
        """Return an obstacle column [n, M] parallel to `kinds`, `default` where unknown."""
        if name not in self.lists:
            return np.full(self.kinds.shape, default)
        column = self.lists[name]
        return np.where(np.isnan(column), default, column)

    def obstacle_count(self) -> NDArray[np.intp]:
        """Return how many obstacles stand in the straight line of each row [n]."""
        return np.asarray((self.kinds != "").sum(axis=1))

    def blocked(self) -> NDArray[np.bool_]:
        """Return which rows [n] have no line of sight: by `los` where known, else by obstacles."""
        sight = self.numbers.get("los", np.full(len(self), np.nan))
        return np.where(np.isnan(sight), self.obstacle_count() > 0, sight == 0)


def scene(frame: pd.DataFrame, source: str = "geometry") -> Scene:
    """Return the scene of a recordings table.

    Raises BenchError where neither `true_range_m` nor both antenna positions are known.
    """
    numbers = {
        str(name): np.asarray(column.astype("float64"))
        for name, column in frame.items()
        if _is_number(column)
    }
    hashes = {name: _hashes(frame[name]) for name in _HASHED if name in frame}
    lists = {name: _padded(frame[name]) for name in _LISTS[1:] if name in frame}
    kinds = _padded_names(frame["obstacles"]) if "obstacles" in frame else _none(len(frame))
    return Scene(numbers, _same_width(lists, kinds), kinds, hashes, _truth(numbers, source))


def _is_number(column: pd.Series) -> bool:
    return bool(pd.api.types.is_numeric_dtype(column) or pd.api.types.is_bool_dtype(column)) or (
        column.name == "los"
    )


def _hashes(column: pd.Series) -> NDArray[np.uint64]:
    values = column.astype("string").fillna("").to_numpy(dtype=object)
    return np.asarray(pd.util.hash_array(values), np.uint64)


def _none(rows: int) -> NDArray[np.str_]:
    return np.zeros((rows, 0), "U1")


def _padded_names(column: pd.Series) -> NDArray[np.str_]:
    """Return a list-of-names column as [n, M], padded with ""."""
    cells = [list(cell) if isinstance(cell, Sequence | np.ndarray) else [] for cell in column]
    width = max(map(len, cells), default=0)
    if width == 0:
        return _none(len(cells))
    return np.array([[*cell, *[""] * (width - len(cell))] for cell in cells], dtype="U32")


def _padded(column: pd.Series) -> Floats:
    """Return a list-of-numbers column as [n, M], padded with NaN."""
    cells = [list(cell) if isinstance(cell, Sequence | np.ndarray) else [] for cell in column]
    width = max(map(len, cells), default=0)
    rows = [[*cell, *[np.nan] * (width - len(cell))] for cell in cells]
    return np.array(rows, np.float64).reshape(len(cells), width)


def _same_width(lists: Mapping[str, Floats], kinds: NDArray[np.str_]) -> dict[str, Floats]:
    """Raise BenchError where an obstacle column is not parallel to `obstacles`."""
    for name, values in lists.items():
        if values.shape != kinds.shape:
            raise BenchError(f"{name}: expected one value per entry of 'obstacles'")
    return dict(lists)


def _truth(numbers: Mapping[str, Floats], source: str) -> Floats:
    """Return the true distance [n]: as given, else between the two antenna positions."""
    if "true_range_m" in numbers:
        truth = numbers["true_range_m"]
    else:
        ends = [_position(numbers, names, source) for names in _ENDS]
        truth = np.linalg.norm(ends[0] - ends[1], axis=1)
    if not np.all(np.isfinite(truth)) or np.any(truth <= 0) or np.any(truth > 1e4):
        raise BenchError(f"{source}: true_range_m must be known and within 0 to 10 km in every row")
    return truth


def _position(numbers: Mapping[str, Floats], names: Sequence[str], source: str) -> Floats:
    missing = next((name for name in names[:2] if name not in numbers), None)
    if missing is not None:
        raise BenchError(f"{source}: no column 'true_range_m' and no {missing!r} to compute it")
    columns = [numbers.get(name, np.zeros_like(numbers[names[0]])) for name in names]
    return np.stack(columns, axis=1)
