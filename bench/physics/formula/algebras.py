"""Columns and constants of an expression, and its reading as arrays of numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.physics.formula.parse import MisfitError
from bench.physics.formula.units import column_unit, unit

Floats = NDArray[np.float64]


class Columns(Protocol):
    """Rows that an expression is evaluated on."""

    def number(self, name: str) -> Floats:
        """Return a numeric column [n] in the unit of its name. Raises BenchError where absent."""

    def label(self, name: str, text: str) -> Floats:
        """Return 1.0 [n] where a column of names holds `text`, else 0.0."""


@dataclass(frozen=True)
class Constant:
    """A named number with its unit, as text: `a = 0.0041 m/m`."""

    value: float
    unit: str

    @property
    def base(self) -> float:
        """The value in base units."""
        return self.value * unit(self.unit).factor


@dataclass(frozen=True)
class Numbers:
    """Evaluates on rows, in base units; NaN where a column is unknown."""

    columns: Columns
    constants: Mapping[str, Constant]
    powers: Mapping[str, float]

    def number(self, value: float) -> Floats:
        """Return the number."""
        return np.asarray(value, np.float64)

    def name(self, name: str) -> Floats:
        """Return a constant, or a column in base units."""
        if name in self.constants:
            return np.asarray(self.constants[name].base)
        return self.columns.number(name) * unit(column_unit(name)).factor

    def label(self, column: str, text: str) -> Floats:
        """Return 1 where the column holds the name."""
        return self.columns.label(column, text)

    def order(self, sign: str, left: Floats, right: Floats) -> Floats:
        """Return 1 where the comparison holds, NaN where a side is unknown."""
        functions = {">": np.greater, "<": np.less, ">=": np.greater_equal, "<=": np.less_equal}
        known = ~(np.isnan(left) | np.isnan(right))
        return np.where(known, functions[sign](left, right), np.nan)

    def combine(self, sign: str, left: Floats, right: Floats, text: str) -> Floats:
        """Return the sum, difference, product or quotient. Raises MisfitError at a zero below."""
        if sign == "/" and np.any(right == 0):
            rows = int(np.sum(right == 0))
            raise MisfitError(f"divides by zero on {rows} row(s): {text} is 0")
        functions = {"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide}
        with np.errstate(all="ignore"):
            return np.asarray(functions[sign](left, right))

    def power(self, base: Floats, exponent: float) -> Floats:
        """Return the power. Raises MisfitError where zero has a negative one."""
        if exponent < 0 and np.any(base == 0):
            raise MisfitError(f"divides by zero on {int(np.sum(base == 0))} row(s)")
        with np.errstate(all="ignore"):
            return _known(np.power(base, exponent), [base])

    def call(self, name: str, arguments: list[Floats]) -> Floats:
        """Return the function's value. Raises MisfitError where it has none."""
        functions = {"atan2": np.arctan2, "round": np.rint}
        with np.errstate(all="ignore"):
            made = functions.get(name, getattr(np, name, None))(*arguments)  # type: ignore[misc]
        return _known(made, arguments)


def _known(made: Floats, given: list[Floats]) -> Floats:
    """Return values, none of which may be unknown where what they come from is known."""
    unknown = np.any([np.isnan(part) for part in np.broadcast_arrays(*given)], axis=0)
    bad = ~np.isfinite(made) & ~unknown
    if np.any(bad):
        raise MisfitError(f"has no value on {int(np.sum(bad))} row(s)")
    return np.asarray(made, np.float64)


def constant(text: str) -> tuple[str, Constant]:
    """Return the name and value of `NAME = NUMBER UNIT`. Raises BenchError on another text."""
    name, sign, rest = text.partition("=")
    number, _, given = rest.strip().partition(" ")
    try:
        value = float(number)
    except ValueError:
        value = float("nan")
    if not sign or not name.strip().isidentifier() or not np.isfinite(value):
        raise BenchError(f"constant {text!r}, expected NAME = NUMBER UNIT, as a = 0.0041 m/m")
    made = Constant(value, given.strip() or "1")
    unit(made.unit)
    return name.strip(), made
