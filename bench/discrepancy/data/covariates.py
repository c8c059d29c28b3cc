"""What the comparison is conditional on: columns that are known before the range is measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.data.observables import SCALARS, Floats
from bench.discrepancy.data.settings import SMALLEST_SPREAD
from bench.discrepancy.settings import LEAST_VARIATION, MOST_CATEGORIES, RAREST_CATEGORY
from bench.recordings.table import CIR_COLUMNS

# Columns that are measured, not known before; "link" is the unit, not a covariate.
MEASURED = {
    *SCALARS, *CIR_COLUMNS, "range_m", "first_path_index", "sample_period_ns", "link",
    "cir_power", "fp_ampl1", "fp_ampl2", "fp_ampl3",
}  # fmt: skip
DEVICES = ("tx=", "rx=")  # how groups of devices begin: in two-way ranging both ends receive
PAIR = "pair"
OF_DEVICES = (*DEVICES, f"{PAIR}=")  # all of whose groups together are those of devices


@dataclass(frozen=True)
class Covariates:
    """Known columns of n rows: `numbers` name -> float64 [n], `groups` name -> bool [n].

    A group is one value of a category (`rx=3`, `environment=hall`, `obstacle=wall`).
    """

    numbers: dict[str, Floats]
    groups: dict[str, NDArray[np.bool_]]

    def matrix(self, names: tuple[str, ...] | None = None) -> Floats:
        """Return [n, q]: the numbers (NaN -> median) and the groups as 0/1."""
        columns = {**self.numbers, **{k: v.astype(np.float64) for k, v in self.groups.items()}}
        chosen = [columns[name] for name in (names or tuple(columns)) if name in columns]
        if not chosen:
            return np.empty((0, 0))
        return np.stack([np.where(np.isfinite(c), c, np.nanmedian(c)) for c in chosen], axis=1)

    def devices(self) -> list[NDArray[np.bool_]]:
        """Return which rows have a device at an end [n], of every device and end."""
        return [group for name, group in self.groups.items() if name.startswith(DEVICES)]


def covariates(frame: pd.DataFrame) -> Covariates:
    """Return every searchable covariate of a recordings table, unknown extra columns included."""
    numbers: dict[str, Floats] = {}
    groups: dict[str, NDArray[np.bool_]] = {}
    for column in map(str, frame.columns):
        if column in MEASURED or _holds_lists(frame[column], column):
            continue
        if column == "obstacles":
            groups |= _obstacles(frame[column])
        elif pd.api.types.is_bool_dtype(frame[column]):
            groups |= _categories(column, frame[column])
        elif pd.api.types.is_numeric_dtype(frame[column]):
            value = np.asarray(frame[column], np.float64)
            if _varies(value, column):
                numbers[column] = value
        else:
            groups |= _categories(column, frame[column])
    return Covariates(numbers, groups | _pairs(frame))


def _varies(values: Floats, column: str) -> bool:
    """Return whether a column varies by more than its last digits; a time may begin anywhere."""
    known = values[np.isfinite(values)]
    size = 0.0 if column == "time_s" else float(np.abs(known).max(initial=0.0))
    least = max(LEAST_VARIATION * size, SMALLEST_SPREAD)
    return bool(len(known)) and float(np.ptp(known)) > least


def _holds_lists(values: pd.Series, column: str) -> bool:
    """Return whether cells are lists (obstacles apart, which have masks of their own)."""
    first = values.iloc[0] if len(values) else None
    return column != "obstacles" and isinstance(first, list | tuple | np.ndarray | dict)


def _categories(column: str, values: pd.Series) -> dict[str, NDArray[np.bool_]]:
    """Return one mask per common value of a category."""
    try:
        share = values.value_counts(normalize=True)
    except TypeError:  # lists or arrays: not a category
        return {}
    if len(share) < 2 or len(share) > MOST_CATEGORIES:
        return {}
    common = share.index[share > RAREST_CATEGORY]
    return {f"{column}={value}": _same(values, value) for value in common}


def _same(values: pd.Series, value: object) -> NDArray[np.bool_]:
    """Return which rows [n] have a value: none of those that are null, which may be any."""
    return np.asarray((values == value).fillna(False), bool)


def _obstacles(values: pd.Series) -> dict[str, NDArray[np.bool_]]:
    """Return a mask per obstacle kind, and one for any obstacle at all."""
    lists = [list(v) if isinstance(v, list | tuple | np.ndarray) else [] for v in values]
    kinds = sorted({kind for row in lists for kind in row})
    masks = {f"obstacle={kind}": np.array([kind in row for row in lists]) for kind in kinds}
    if kinds:
        masks["obstructed"] = np.array([bool(row) for row in lists])
    return {name: mask for name, mask in masks.items() if RAREST_CATEGORY < mask.mean() < 1}


def _pairs(frame: pd.DataFrame) -> dict[str, NDArray[np.bool_]]:
    """Return a mask per pair of devices, where there are several and not too many."""
    if "tx" not in frame or "rx" not in frame:
        return {}
    pair = frame["tx"].astype(str) + "->" + frame["rx"].astype(str)
    return _categories(PAIR, pair)
