"""Units of columns, by pint: what a quantity is kept in, and how to get there."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.table import FLOAT_COLUMNS

if TYPE_CHECKING:
    import pint

Floats = NDArray[np.float64]
FIXED_POINT = "10.6"  # ten bits before the point, six behind: FP_INDEX of the DW1000
DW1000_TICK = "dw_tick"
_SUFFIXES = {
    "_dbm": ("dBm", "level"),
    "_ppm": ("ppm", "ratio"),
    "_mhz": ("MHz", "frequency"),
    "_deg": ("degree", "angle"),
    "_ns": ("ns", "time"),
    "_m": ("m", "length"),
    "_s": ("s", "time"),
    "_c": ("degC", "temperature"),
}
_EXAMPLES = {
    "level": "dBm or mW",
    "ratio": "ppm or ppb",
    "frequency": "MHz or GHz",
    "angle": "deg or rad",
    "time": "s, ms or dw_tick",
    "length": "m, cm or mm",
    "temperature": "degC, degF or K",
}
EXTRA_COLUMNS = ("prf_mhz", "tx_power_dbm", "room_x_m", "room_y_m", "room_z_m")


def base_names() -> dict[str, str]:
    """Return the float columns by their name without unit: `range` -> `range_m`."""
    return {_without_unit(name): name for name in (*FLOAT_COLUMNS, *EXTRA_COLUMNS)}


def _without_unit(column: str) -> str:
    suffix = next((end for end in _SUFFIXES if column.endswith(end)), "")
    return column.removesuffix(suffix)


def converter(column: str, unit: str, where: str) -> Callable[[Floats], Floats]:
    """Return what turns numbers in `unit` into those of `column`.

    `where` begins the message. Raises BenchError for a unit that is not known, or measures
    something else (`s` for a range).
    """
    if column == "first_path_index" and unit == FIXED_POINT:
        return lambda numbers: numbers / 64.0
    ends = [end for end in _SUFFIXES if column.endswith(end)]
    if not ends:
        raise BenchError(f"{where}: {column} has no unit; expected none{_fixed(column)}")
    own, kind = _SUFFIXES[ends[0]]
    expected = f"expected a {kind} such as {_EXAMPLES[kind]}"
    units = _registry()
    try:
        source, target = units.Unit(unit), units.Unit(own)
    except Exception as problem:  # pint raises its own errors, tokenize's and plain ones
        raise BenchError(f"{where}: unknown unit {unit!r}; {expected}") from problem
    if not source.is_compatible_with(target):
        raise BenchError(f"{where}: {unit!r} is no {kind}; {expected}")
    return lambda numbers: _converted(numbers, source, target)


def _fixed(column: str) -> str:
    return f", or {FIXED_POINT}" if column == "first_path_index" else ""


def _converted(numbers: Floats, source: Any, target: Any) -> Floats:
    """Return numbers in another unit; a level of no power is -inf."""
    with np.errstate(divide="ignore", invalid="ignore"):
        found = _registry().Quantity(numbers, source).to(target)
    return np.asarray(found.magnitude, np.float64)


@cache
def _registry() -> pint.UnitRegistry[Any]:
    """Return the units, with the tick of the DW1000's counters added."""
    import pint

    units: pint.UnitRegistry[Any] = pint.UnitRegistry(autoconvert_offset_to_baseunit=True)
    units.define("ppb = 1e-9")
    units.define(f"{DW1000_TICK} = {1 / (128 * 499.2e6)!r} second")
    return units
