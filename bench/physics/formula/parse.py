"""The allow-list: which texts are expressions, and what each construct means to an algebra."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Mapping
from functools import lru_cache
from math import isfinite
from typing import Protocol, TypeVar

from bench.errors import BenchError, unknown_name

LONGEST = 1200
DEEPEST = 24
FUNCTIONS = {
    "abs": 1, "sqrt": 1, "exp": 1, "log": 1, "sin": 1, "cos": 1, "floor": 1, "round": 1,
    "atan2": 2, "minimum": 2, "maximum": 2,
}  # fmt: skip  # allowed functions and how many arguments they take
HIGHEST_POWER = 8.0
_ALLOWED = "numbers, columns, constants, + - * / **, comparisons and " + ", ".join(FUNCTIONS)
_SIGNS: dict[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
}  # fmt: skip
_ORDERS: dict[type[ast.cmpop], str] = {
    ast.Gt: ">", ast.Lt: "<", ast.GtE: ">=", ast.LtE: "<=",
}  # fmt: skip
T = TypeVar("T")


class MisfitError(Exception):
    """What two parts cannot do together; the walk adds where."""


class Algebra(Protocol[T]):
    """One reading of an expression: numbers, units or symbols."""

    @property
    def powers(self) -> Mapping[str, float]:
        """Return the constants that may be exponents, by name."""

    def number(self, value: float) -> T:
        """Return the reading of a number."""

    def name(self, name: str) -> T:
        """Return the reading of a column or constant."""

    def label(self, column: str, text: str) -> T:
        """Return 1 where a column of names has this name, else 0."""

    def order(self, sign: str, left: T, right: T) -> T:
        """Return 1 where a comparison holds, else 0."""

    def combine(self, sign: str, left: T, right: T, text: str) -> T:
        """Return a sum, difference, product or quotient; `text` is that of the right side."""

    def power(self, base: T, exponent: float) -> T:
        """Return a power."""

    def call(self, name: str, arguments: list[T]) -> T:
        """Return a function's value."""


@lru_cache(maxsize=256)
def tree(text: str) -> ast.expr:
    """Return the syntax tree of an expression; nothing is run.

    Raises BenchError where it is too long, too deep or no expression. What it may hold is checked
    by every walk.
    """
    if len(text) > LONGEST:
        raise BenchError(f"expression of {len(text)} characters, expected at most {LONGEST}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as problem:
        raise BenchError(f"expression {_short(text)}: {problem.__class__.__name__}") from problem
    if depth(made) > DEEPEST:
        raise BenchError(f"expression {_short(text)}: deeper than {DEEPEST} levels")
    return made


def depth(node: ast.AST) -> int:
    """Return how many levels a tree has, without recursion: texts from elsewhere may be deep."""
    level, now = 0, [node]
    while now:
        level, now = level + 1, [child for part in now for child in ast.iter_child_nodes(part)]
    return level


def _short(text: str) -> str:
    return repr(text if len(text) < 60 else f"{text[:57]}...")


def walk(node: ast.expr, algebra: Algebra[T]) -> T:
    """Return the reading of an expression. Raises BenchError on what is not in the allow-list."""
    try:
        return _read(node, algebra)
    except MisfitError as problem:
        raise BenchError(f"{problem} in {_short(ast.unparse(node))}") from problem


def _read(node: ast.expr, algebra: Algebra[T]) -> T:
    match node:
        case ast.Constant(value=bool() | str() | bytes()):
            raise BenchError(f"{_short(ast.unparse(node))} is no number")
        case ast.Constant(value=int() | float()):
            return algebra.number(_finite(node.value))
        case ast.Name():
            return algebra.name(node.id)
        case ast.UnaryOp(op=ast.USub() | ast.UAdd()):
            sign = -1.0 if isinstance(node.op, ast.USub) else 1.0
            return algebra.combine("*", algebra.number(sign), walk(node.operand, algebra), "")
        case ast.BinOp(op=ast.Pow()):
            return algebra.power(walk(node.left, algebra), _exponent(node.right, algebra))
        case ast.BinOp() if type(node.op) in _SIGNS:
            return _combined(node, algebra)
        case ast.Compare(ops=[_]):
            return _compared(node, algebra)
        case ast.Call(func=ast.Name(), keywords=[]):
            return _called(node, algebra)
    raise BenchError(f"{_short(ast.unparse(node))} is not allowed; expected {_ALLOWED}")


def _combined(node: ast.BinOp, algebra: Algebra[T]) -> T:
    left, right = walk(node.left, algebra), walk(node.right, algebra)
    return algebra.combine(_SIGNS[type(node.op)], left, right, ast.unparse(node.right))


def _finite(value: object) -> float:
    """Return a number of the text as a float. Raises BenchError where it is too large."""
    try:
        made = float(value) if isinstance(value, int | float) else float("nan")
    except OverflowError:
        made = float("inf")
    if not isfinite(made):
        raise BenchError("a number in the expression is too large")
    return made


def _exponent(node: ast.expr, algebra: Algebra[T]) -> float:
    """Return an exponent, which must be known before any row: a number, or a constant's name."""
    match node:
        case ast.UnaryOp(op=ast.USub()):
            return -_exponent(node.operand, algebra)
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            value = _finite(node.value)
        case ast.Name() if node.id in algebra.powers:
            value = algebra.powers[node.id]
        case _:
            raise BenchError(
                f"exponent {_short(ast.unparse(node))}, expected a number or a constant of no unit"
            )
    if abs(value) > HIGHEST_POWER:
        raise BenchError(f"exponent {value:g}, expected within {HIGHEST_POWER:g} of zero")
    return value


def _compared(node: ast.Compare, algebra: Algebra[T]) -> T:
    match node:
        case ast.Compare(
            left=ast.Name(id=column), ops=[ast.Eq()], comparators=[ast.Constant(value=str() as one)]
        ):
            return algebra.label(column, one)
    sign = _ORDERS.get(type(node.ops[0]))
    if sign is None:
        raise BenchError(
            f"{_short(ast.unparse(node))} is not allowed; expected <, <=, >, >= between numbers, "
            'or COLUMN == "NAME"'
        )
    return algebra.order(sign, walk(node.left, algebra), walk(node.comparators[0], algebra))


def _called(node: ast.Call, algebra: Algebra[T]) -> T:
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if name not in FUNCTIONS:
        raise unknown_name("function", name, FUNCTIONS)
    if len(node.args) != FUNCTIONS[name]:
        raise BenchError(f"{name}: {len(node.args)} arguments, expected {FUNCTIONS[name]}")
    return algebra.call(name, [walk(part, algebra) for part in node.args])
