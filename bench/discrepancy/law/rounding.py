"""Rounding as a structure: measured ranges lie on a lattice."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Comparison
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import error_m
from bench.discrepancy.law.forms import Named
from bench.discrepancy.law.likelihood import fixed
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.settings import LAW_LATTICE, LAW_ON_LATTICE, LAW_ONE_STEP
from bench.discrepancy.law.structures import Fitted
from bench.physics.effects.ranging.range_rounding import SAME_STEP

Floats = NDArray[np.float64]
_WAYS = {"round": "to the nearest", "floor": "down to a"}


@dataclass(frozen=True)
class Rounding:
    """Ranges are multiples of a step: to the nearest one, or down."""

    step_m: float
    way: str
    choices: int = 2
    free: int = 1
    form: str = "rounding"
    fault: str = ""
    columns: tuple[str, ...] = ("range_m",)
    where: str = ""

    @property
    def expression(self) -> str:
        """Its expression."""
        return f"q * {self.way}(range_m / q) - range_m"

    def fitted(self, given: Material) -> Fitted:
        """Return it with the step of the lattice."""
        constants = (("q", self.step_m, "m"),)
        return Fitted(constants, fixed(self.shift_m(given, constants), given.residual_m))

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of rows, by the simulated range."""
        q = constants[0][1]
        steps = (np.rint if self.way == "round" else np.floor)(given.range_m / q)
        return np.asarray(q * steps - given.range_m)

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        return f"ranges are rounded {_WAYS[self.way]} multiple of {shown['q']}"


def roundings(given: Material) -> Iterator[Rounding]:
    """Yield a rounding where measured ranges lie on a lattice and simulated ones do not."""
    step = None if given.rounded else lattice_m(given.range_m + given.residual_m)
    if step is not None and not _fits(given.range_m, step):
        for way in _WAYS:
            yield Rounding(step, way)


def lattice_m(values: Floats) -> float | None:
    """Return the step in metres that nearly all values [n] are multiples of, None without one."""
    gaps = np.diff(np.unique(values))
    gaps = gaps[gaps > LAW_LATTICE[0] / 2]
    if not len(gaps):
        return None
    step = float(np.median(gaps[gaps < LAW_ONE_STEP * gaps.min()]))
    for _ in range(3):  # finer with every pass: far multiples say more
        whole = np.rint(values / step)
        step = float((values * whole).sum() / max((whole**2).sum(), 1))
    inside = LAW_LATTICE[0] <= step <= LAW_LATTICE[1]
    return step if inside and _fits(values, step) else None


def _fits(values: Floats, step: float) -> bool:
    """Return whether nearly all values are multiples of a step."""
    off = np.abs(values / step - np.rint(values / step))
    return bool(np.mean(off < LAW_ON_LATTICE[0]) >= LAW_ON_LATTICE[1])


def rounds_alike(comparison: Comparison, rows: Material) -> bool:
    """Return whether the ranges of another simulator's table are rounded as the recorded ones."""
    if not isinstance(comparison, TableComparison):
        return False
    mine = lattice_m(rows.range_m + rows.residual_m)
    if mine is None:
        return False
    range_m = numeric(comparison.frame, "true_range_m") + error_m(comparison.frame)
    theirs = lattice_m(range_m[np.isfinite(range_m)])
    return theirs is not None and abs(theirs - mine) < SAME_STEP * mine
