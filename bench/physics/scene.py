"""What is known of the rows before anything is simulated: positions, obstacles, settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.physics.memory import Memory
from bench.physics.units import Floats
from bench.recordings.motion import with_radial_speed

_ENDS = tuple(tuple(f"{end}_{axis}_m" for axis in "xyz") for end in ("tx", "rx"))
OBSTACLE_LISTS = (
    "obstacle_thickness_m",
    "obstacle_at",
    "obstacle_clearance_m",
    "obstacle_far_clearance_m",
    "obstacle_incidence_deg",
)
"""Columns whose cells have a value for each of the `obstacles`."""
_SEQUENCES = (list, tuple, np.ndarray)
KEPT_PARTS, KEPT_FIGURES = 4, 8
_HASHED = ("link", "tx", "rx", "environment")


@dataclass(frozen=True)
class Scene:
    """The known columns of n rows as arrays.

    `numbers` holds float64 [n] (NaN = unknown), `lists` float64 [n, M] padded with NaN for the
    obstacle columns, `kinds` the obstacles [n, M] as positions in `kind_names` (-1 = padding),
    `hashes` uint64 [n] of the string columns, for draws that are equal within a link or device.
    `parts` and `known` remember slices and what follows from the rows alone, such as image paths:
    the same rows are simulated again and again.
    """

    numbers: Mapping[str, Floats]
    lists: Mapping[str, Floats]
    kinds: NDArray[np.int16]
    kind_names: tuple[str, ...]
    hashes: Mapping[str, NDArray[np.uint64]]
    true_range_m: Floats
    parts: Memory[Any] = field(
        default_factory=lambda: Memory(KEPT_PARTS), compare=False, repr=False
    )
    known: Memory[Any] = field(
        default_factory=lambda: Memory(KEPT_FIGURES), compare=False, repr=False
    )

    def __len__(self) -> int:
        return len(self.true_range_m)

    def slice(self, start: int, stop: int) -> Scene:
        """Return rows `start` to `stop`; the same object for the same rows, while remembered."""
        if start == 0 and stop >= len(self):
            return self
        found: Scene = self.parts.get((start, stop), lambda: self._part(start, stop))
        return found

    def _part(self, start: int, stop: int) -> Scene:
        """Return rows `start` to `stop` as an object of their own."""
        part = slice(start, stop)
        return Scene(
            {name: column[part] for name, column in self.numbers.items()},
            {name: column[part] for name, column in self.lists.items()},
            self.kinds[part],
            self.kind_names,
            {name: column[part] for name, column in self.hashes.items()},
            self.true_range_m[part],
        )

    def repeated(self, times: int) -> Scene:
        """Return the rows several times, one after the other; the same object while remembered."""
        if times == 1:
            return self
        found: Scene = self.parts.get(("repeated", times), lambda: stacked([self] * times))
        return found

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
        return np.asarray((self.kinds >= 0).sum(axis=1))

    def count_by_kind(self) -> Floats:
        """Return how many obstacles of every kind that is there stand in the way [n, k]."""
        every = np.unique(self.kinds[self.kinds >= 0])
        return np.asarray((self.kinds[:, None] == every[:, None]).sum(axis=2), np.float64)

    def clear(self) -> NDArray[np.bool_]:
        """Return which rows [n] have nothing in the straight line."""
        return np.asarray(~self.blocked() & (self.obstacle_count() == 0))

    def blocked(self) -> NDArray[np.bool_]:
        """Return which rows [n] have no line of sight: by `los` where known, else by obstacles."""
        sight = self.numbers.get("los", np.full(len(self), np.nan))
        return np.where(np.isnan(sight), self.obstacle_count() > 0, sight == 0)


def stacked(scenes: Sequence[Scene]) -> Scene:
    """Return the rows of scenes of the same columns, one scene's under the other's.

    Raises ValueError where their columns are not the same.
    """
    first = scenes[0]
    if any(one.kind_names != first.kind_names for one in scenes):
        raise ValueError("scenes with other kinds of obstacles")
    numbers, lists, hashes = (
        _under([getattr(one, name) for one in scenes]) for name in ("numbers", "lists", "hashes")
    )
    kinds = np.concatenate([one.kinds for one in scenes])
    truth = np.concatenate([one.true_range_m for one in scenes])
    return Scene(numbers, lists, kinds, first.kind_names, hashes, truth)


def _under(columns: Sequence[Mapping[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Return columns of the same names, one scene's under the other's."""
    if any(one.keys() != columns[0].keys() for one in columns):
        raise ValueError("scenes with other columns")
    return {name: np.concatenate([one[name] for one in columns]) for name in columns[0]}


def scene(frame: pd.DataFrame, source: str = "geometry", *, moving: bool = True) -> Scene:
    """Return the scene of a recordings table, with the radial speed that follows from its times.

    Not `moving`: nobody will ask for that speed, which takes longer than all the rest.
    An infinite number is not known, like an empty one.
    Raises BenchError where neither `true_range_m` nor both antenna positions are known.
    """
    frame = with_radial_speed(frame) if moving else frame
    numbers = {
        str(name): _known(np.asarray(column.astype("float64")))
        for name, column in frame.items()
        if _is_number(column)
    }
    hashes = {name: _hashes(frame[name]) for name in _HASHED if name in frame}
    kinds, names = _kinds(frame)
    lists = {name: _padded(frame[name], kinds) for name in OBSTACLE_LISTS if name in frame}
    return Scene(numbers, lists, kinds, names, hashes, _truth(numbers, source))


def _known(values: Floats) -> Floats:
    """Return a column [n] with NaN for what is infinite: effects would make ranges of it."""
    return np.where(np.isinf(values), np.nan, values) if np.isinf(values).any() else values


def _is_number(column: pd.Series) -> bool:
    return bool(pd.api.types.is_numeric_dtype(column) or pd.api.types.is_bool_dtype(column)) or (
        column.name == "los"
    )


def _hashes(column: pd.Series) -> NDArray[np.uint64]:
    codes, names = pd.factorize(column.to_numpy(dtype=object))
    texts = np.array(["", *map(str, names)], object)  # an unknown name has code -1
    return np.asarray(pd.util.hash_array(texts, categorize=False)[codes + 1], np.uint64)


def _kinds(frame: pd.DataFrame) -> tuple[NDArray[np.int16], tuple[str, ...]]:
    """Return the `obstacles` column as codes [n, M], padded with -1, and the kinds' names."""
    if "obstacles" not in frame:
        return np.full((len(frame), 0), -1, np.int16), ()
    cells = _lists(frame["obstacles"])
    sizes = np.fromiter(map(len, cells), np.intp, len(cells))
    codes, names = pd.factorize(np.array([str(k) for cell in cells for k in cell], object))
    kinds = np.full((len(cells), sizes.max(initial=0)), -1, np.int16)
    kinds[np.arange(kinds.shape[1]) < sizes[:, None]] = codes
    return kinds, tuple(map(str, names))


def _lists(column: pd.Series) -> Sequence[Any]:
    """Return the cells of a column of lists, an empty one where a cell is none."""
    cells = column.tolist()
    if all(issubclass(kind, _SEQUENCES) for kind in set(map(type, cells))):
        return cells  # some thousand cells are sooner looked at by their few types
    return [cell if isinstance(cell, _SEQUENCES) else () for cell in cells]


def _padded(column: pd.Series, kinds: NDArray[np.int16]) -> Floats:
    """Return a list-of-numbers column as [n, M] like `kinds`, padded with NaN.

    Raises BenchError where it does not hold one value per obstacle.
    """
    cells = _lists(column)
    sizes = np.fromiter(map(len, cells), np.intp, len(cells))
    if not np.array_equal(sizes, (kinds >= 0).sum(axis=1)):
        raise BenchError(f"{column.name}: expected one value per entry of 'obstacles'")
    made = np.full(kinds.shape, np.nan)
    made[kinds >= 0] = np.concatenate([np.empty(0), *cells])
    return made


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
