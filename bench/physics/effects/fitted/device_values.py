"""Values per device, and lists in an effect's fields: what the fitted effects share."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import trim_mean

from bench.errors import BenchError
from bench.physics.scene import Scene
from bench.physics.units import Floats

Curves = tuple[tuple[float, ...], ...]
CUT = 1 / 3  # of devices at either end, which may be far off


@lru_cache(maxsize=256)
def name_hash(names: tuple[str, ...]) -> NDArray[np.uint64]:
    """Return the hashes that `Scene.hashes` uses for these names."""
    return np.asarray(pd.util.hash_array(np.array(names, dtype=object)), np.uint64)


def at_end(rows: Scene, end: str, devices: tuple[str, ...], values: tuple[float, ...]) -> Floats:
    """Return each row's value for its device at one end [n]; 0 for a device not listed."""
    if not devices:
        return np.zeros(len(rows))
    known, wanted = name_hash(devices), rows.group(end)
    order = np.argsort(known)
    place = order[np.minimum(np.searchsorted(known[order], wanted), len(known) - 1)]
    return np.where(known[place] == wanted, np.asarray(values, np.float64)[place], 0.0)


def beside_middle(values: Sequence[float] | Floats) -> Floats:
    """Return values of devices [k] beside the mean of the middle third of them (a trimmed mean).

    Where only differences act. Beside the mean of all, one that is off would have all others be
    off; beside the median one, its own error would be that of all (Tukey and McLaughlin 1963).
    """
    given = np.asarray(values, np.float64)
    return np.asarray(given - trim_mean(given, CUT)) if given.size else given


def as_tuples(effect: Any, **lengths: int | None) -> None:
    """Turn list fields (as TOML gives them) into tuples and check their lengths."""
    for name, length in lengths.items():
        value = tuple(getattr(effect, name))
        if length is not None and len(value) != length:
            raise BenchError(f"effect {effect.name!r}: expected {length} values in {name}")
        object.__setattr__(effect, name, value)


def as_curves(effect: Any, knots: str, values: str, count: int) -> None:
    """Turn lists of lists into tuples of tuples and check that they are `count` curves, or none."""
    for name in (knots, values):
        object.__setattr__(effect, name, tuple(tuple(map(float, c)) for c in getattr(effect, name)))
    at, given = getattr(effect, knots), getattr(effect, values)
    if len(at) not in (0, count) or list(map(len, at)) != list(map(len, given)):
        raise BenchError(
            f"effect {effect.name!r}: expected as many {values} as {knots}, for each of "
            f"{count} devices"
        )
    if any(b <= a for curve in at for a, b in pairwise(curve)):
        raise BenchError(f"effect {effect.name!r}: {knots} must increase")
