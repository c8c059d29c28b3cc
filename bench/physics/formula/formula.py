"""A formula: an expression with its constants, checked once, evaluated on rows in metres."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy

from bench.errors import BenchError
from bench.physics.formula.algebras import Columns, Constant, Floats, Numbers, constant
from bench.physics.formula.parse import tree, walk
from bench.physics.formula.symbolic import Symbols, Units
from bench.physics.formula.units import kind_words, unit

MOST_CONSTANTS = 40


@dataclass(frozen=True)
class Formula:
    """An expression in metres over columns of the recordings table and named constants.

    `constants` are texts such as `a = 0.0041 m/m`. Raises BenchError where the expression is not
    of the allow-list, or its unit is not that of a length.
    """

    expression: str
    constants: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if len(self.constants) > MOST_CONSTANTS:
            raise BenchError(f"{len(self.constants)} constants, expected at most {MOST_CONSTANTS}")
        kind = walk(tree(self.expression), Units(self.values, self._powers))
        if kind != unit("m").kind:
            raise BenchError(
                f"units do not fit: {self.expression!r} is in {kind_words(kind)}, not m"
            )

    @cached_property
    def values(self) -> Mapping[str, Constant]:
        """The constants by name."""
        return dict(map(constant, self.constants))

    @cached_property
    def _powers(self) -> dict[str, float]:
        """The constants that may be exponents: those of no unit."""
        return {n: c.base for n, c in self.values.items() if unit(c.unit).kind == 1}

    def metres(self, columns: Columns, rows: int) -> Floats:
        """Return the formula's value on `rows` rows [n] in metres, NaN where a column is unknown.

        Raises BenchError where it divides by zero or has no value on some row.
        """
        made = walk(tree(self.expression), Numbers(columns, self.values, self._powers))
        if np.any(np.isinf(made)):
            raise BenchError(f"{self.expression!r} overflows on {int(np.isinf(made).sum())} row(s)")
        return np.broadcast_to(made, (rows,)).astype(np.float64)

    @property
    def shown(self) -> str:
        """The formula with its constants put in, powers as ^, for people."""
        made = walk(tree(self.expression), Symbols(self.values, self._powers))
        return str(sympy.sstr(made, order="none")).replace("**", "^")
