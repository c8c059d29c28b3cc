"""A law without a name: an expression over the rows' columns that is data, never code."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from bench.errors import BenchError, unknown_name
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_values import as_tuples, name_hash
from bench.physics.randomness import Draws
from bench.physics.units import Floats

if TYPE_CHECKING:
    from bench.physics.formula.formula import Formula

MEASURED = ("range_m", "rx_power_dbm", "first_path_power_dbm")


@dataclass(frozen=True)
class Law(Effect):
    """LAW: ranges read long by an expression over the columns of the rows.

    `expression` is in metres: numbers, columns, `constants` such as "a = 0.0041 m/m", + - * / **,
    comparisons (1 where they hold: `time_s > t0`, `rx == "a2"`) and a few functions; see
    `bench.physics.formula`. Units are those that column names end in. `range_m` and the powers are
    what was simulated so far. Rows where a column is unknown are left alone.
    """

    name = "law"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "found in recordings by bench diagnose, or written down by a user"
    signature = "error by an expression over known columns; CIR unchanged"
    last = True

    expression: str = "0 * true_range_m"
    constants: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.expression, str) or not isinstance(self.constants, list | tuple):
            raise BenchError("effect 'law': expression is a text, constants are a list of texts")
        as_tuples(self, constants=None)
        if not all(isinstance(text, str) for text in self.constants):
            raise BenchError("effect 'law': constants are a list of texts, as a = 0.0041 m/m")
        try:
            _formula(self.expression, self.constants)
        except BenchError as problem:
            raise BenchError(f"effect 'law': {problem}") from problem

    @property
    def formula(self) -> Formula:
        """The expression, parsed and checked."""
        return _formula(self.expression, self.constants)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the expression's value. Raises BenchError where it has none."""
        metres = self.formula.metres(_Columns(batch), len(batch))
        return batch.longer(np.nan_to_num(metres))


@lru_cache(maxsize=256)
def _formula(expression: str, constants: tuple[str, ...]) -> Formula:
    from bench.physics.formula.formula import Formula  # needs sympy, half a second to import

    return Formula(expression, constants)


@dataclass(frozen=True)
class _Columns:
    """The columns of a batch, as an expression names them."""

    batch: Batch

    def number(self, name: str) -> Floats:
        """Return a numeric column [n], NaN where unknown. Raises BenchError where absent."""
        rows = self.batch.rows
        known = {**rows.numbers, "true_range_m": rows.true_range_m}
        known |= {n: v for n in MEASURED if (v := getattr(self.batch, n)) is not None}
        if name not in known:
            raise unknown_name("column or constant", name, known)
        return np.asarray(known[name], np.float64)

    def label(self, name: str, text: str) -> Floats:
        """Return 1.0 [n] where a column of names, or any obstacle, is `text`."""
        rows = self.batch.rows
        if name == "obstacles":
            kinds = [i for i, kind in enumerate(rows.kind_names) if kind == text]
            return np.asarray(np.isin(rows.kinds, kinds).any(axis=1), np.float64)
        if name not in rows.hashes:
            raise unknown_name("column of names", name, [*rows.hashes, "obstacles"])
        return np.asarray(rows.hashes[name] == name_hash((text,))[0], np.float64)


def with_constants(expression: str, constants: Iterable[tuple[str, float, str]]) -> Law:
    """Return a law whose constants are given as name, value and unit."""
    return Law(expression, tuple(f"{name} = {value!r} {unit}" for name, value, unit in constants))
