"""Two readings of an expression by sympy: its unit, and symbols for people to read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy
from sympy import Expr

from bench.physics.formula.algebras import Constant
from bench.physics.formula.parse import MisfitError
from bench.physics.formula.units import column_unit, kind_words, unit


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
