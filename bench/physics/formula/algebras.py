"""Three readings of an expression: arrays of numbers, units, and sympy for people to read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import sympy
from numpy.typing import NDArray
from sympy import Expr

from bench.errors import BenchError
from bench.physics.formula.parse import MisfitError
from bench.physics.formula.units import column_unit, kind_words, unit

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


@dataclass(frozen=True)
class Units:
    """Reads the unit alone. Raises MisfitError where units do not fit."""

    constants: Mapping[str, Constant]
    powers: Mapping[str, float]

    def number(self, value: float) -> Expr:
        """Return no unit."""
        return sympy.Integer(1)

    def name(self, name: str) -> Expr:
        """Return the unit of a constant or column."""
        given = self.constants[name].unit if name in self.constants else column_unit(name)
        return unit(given).kind

    def label(self, column: str, text: str) -> Expr:
        """Return no unit."""
        return sympy.Integer(1)

    def order(self, sign: str, left: Expr, right: Expr) -> Expr:
        """Return no unit; both sides must be of one."""
        _same(sign, left, right)
        return sympy.Integer(1)

    def combine(self, sign: str, left: Expr, right: Expr, text: str) -> Expr:
        """Return the unit of the sum, difference, product or quotient."""
        if sign in "+-":
            return _same(sign, left, right)
        return left * right if sign == "*" else left / right

    def power(self, base: Expr, exponent: float) -> Expr:
        """Return the unit of a power."""
        return base ** sympy.Rational(str(exponent)) if base != 1 else base

    def call(self, name: str, arguments: list[Expr]) -> Expr:
        """Return the unit of a function's value."""
        if name in ("abs", "minimum", "maximum"):
            return _same(name, arguments[0], arguments[-1])
        if name == "sqrt":
            return sympy.sqrt(arguments[0])
        if name == "atan2":
            _same(name, *arguments)
        elif arguments[0] != 1:
            raise MisfitError(f"{name} of {kind_words(arguments[0])}, expected no unit,")
        return sympy.Integer(1)


def _same(what: str, left: Expr, right: Expr) -> Expr:
    if left != right:
        raise MisfitError(f"units do not fit: {kind_words(left)} {what} {kind_words(right)}")
    return left


@dataclass(frozen=True)
class Symbols:
    """Reads an expression into sympy: constants as rounded numbers with units."""

    constants: Mapping[str, Constant]
    powers: Mapping[str, float]

    def number(self, value: float) -> Expr:
        """Return a number, whole where it is."""
        return sympy.Integer(int(value)) if value.is_integer() else sympy.Float(value, 4)

    def name(self, name: str) -> Expr:
        """Return a symbol that prints as a number with unit, or as the column."""
        if name not in self.constants:
            return sympy.Symbol(name)
        item = self.constants[name]
        if item.unit == "1":
            return self.number(item.value)
        return sympy.Symbol(f"({item.value:.4g} {item.unit})")

    def label(self, column: str, text: str) -> Expr:
        """Return a symbol for the condition."""
        return sympy.Symbol(f"[{column} = {text}]")

    def order(self, sign: str, left: Expr, right: Expr) -> Expr:
        """Return a symbol for the condition."""
        return sympy.Symbol(f"[{left} {sign} {right}]")

    def combine(self, sign: str, left: Expr, right: Expr, text: str) -> Expr:
        """Return the sum, difference, product or quotient."""
        if sign in "+-":
            return left + right if sign == "+" else left - right
        return left * right if sign == "*" else left / right

    def power(self, base: Expr, exponent: float) -> Expr:
        """Return the power."""
        return base ** self.number(exponent)

    def call(self, name: str, arguments: list[Expr]) -> Expr:
        """Return the function, unevaluated."""
        known = {"sqrt": sympy.sqrt, "abs": sympy.Abs}
        return known.get(name, sympy.Function(name))(*arguments)


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
