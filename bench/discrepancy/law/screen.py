"""Every form over every covariate times every factor, at once: which are worth fitting in full."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.forms import CONSTANT, FORMS, Form, over_what
from bench.discrepancy.law.likelihood import first_scale
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.settings import LAW_ALIKE, LAW_CLIP, LAW_REFINED
from bench.discrepancy.law.structures import GridLaw, cost

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _Target:
    """What is explained, and the factors' sums that all forms share."""

    residual_m: Floats
    weights: Floats  # [n, K]

    @property
    def total(self) -> float:
        """Sum of squares."""
        return float((self.residual_m**2).sum())


def promising(given: Material, rows: float) -> list[GridLaw]:
    """Return the structures that remove most, complexity paid; `rows` count as independent.

    Residuals are taken once as they are and once cut, so that neither a few wild rows nor a
    law that moves few rows far is lost.
    """
    weights = np.stack([factor.weights for factor in given.factors], axis=1)
    cut = LAW_CLIP * first_scale(given.residual_m)
    chosen: dict[tuple[object, ...], GridLaw] = {}
    for target in (given.residual_m, np.clip(given.residual_m, -cut, cut)):
        scored = list(_scored(given, _Target(target, weights), rows))
        scored.sort(key=lambda one: -one[0])
        for _, law in scored[:LAW_REFINED]:
            chosen.setdefault((law.shape.text, law.at, law.by, law.offset), law)
    return [_bracketed(given, law) for law in chosen.values()]


def _bracketed(given: Material, law: GridLaw) -> GridLaw:
    """Return the structure with the interval that its free constant is searched in."""
    return replace(law, bounds=law.shape.bounds(over_what(given, law.at), law.value))


def _scored(given: Material, target: _Target, rows: float) -> Iterator[tuple[float, GridLaw]]:
    """Yield every structure at its best screened constant, with its gain in nats."""
    pairs = [(CONSTANT, -1), *((form, at) for at in range(len(given.columns)) for form in FORMS)]
    grids = [(form, at, form.grid(over_what(given, at))) for form, at in pairs]
    count = sum(len(grid) > 0 for _, _, grid in grids)
    for form, at, grid in grids:
        if not len(grid):
            continue
        parts = form.basis(over_what(given, at), grid)
        for offset in form.offset:
            removed = _removed(parts, target, offset)
            best = removed.argmax(axis=0)
            for by in range(len(given.factors)):
                law = _law(given, form, at, by, offset, float(grid[best[by]]), count)
                if law is not None:
                    yield _gain(removed[best[by], by], target, rows) - cost(law, rows), law


def _gain(removed: float, target: _Target, rows: float) -> float:
    """Return the gain in nats of removing a part of the sum of squares."""
    left = max(1 - removed / max(target.total, 1e-300), 1e-12)
    return float(-rows / 2 * np.log(left))


def _law(
    given: Material, form: Form, at: int, by: int, offset: bool, value: float, pairs: int
) -> GridLaw | None:
    """Return the structure, None where it says the same as a simpler one."""
    column, factor = over_what(given, at), given.factors[by]
    if by and (factor.text == column.text or (at < 0 and not factor.group)):
        return None
    choices = 2 * pairs * (len(given.factors) if by else 1)
    names = (column.text, column.words, factor.text, factor.words, factor.unit)
    return GridLaw(form, at, by, offset, value, (value, value), choices, names)


def _removed(parts: tuple[Floats, ...], target: _Target, offset: bool) -> Floats:
    """Return the sum of squares [G, K] that least squares removes, per free value and factor."""
    r, w = target.residual_m, target.weights
    squared = w**2
    to_r = [(part * r) @ w for part in parts]
    among = [[(a * b) @ squared for b in parts] for a in parts]
    sizes = [row[i] for i, row in enumerate(among)]
    start = np.zeros(w.shape[1])
    if offset:
        own = np.maximum(squared.sum(axis=0), 1e-300)
        of_r, means = r @ w, [part @ squared for part in parts]
        to_r = [t - m * of_r / own for t, m in zip(to_r, means, strict=True)]
        among = [[v - a * b / own for v, b in zip(row, means)] for row, a in zip(among, means)]  # noqa: B905
        start = of_r**2 / own
    return start + (_one if len(parts) == 1 else _two)(among, to_r, sizes)


def _one(among: list[list[Floats]], to_r: list[Floats], sizes: list[Floats]) -> Floats:
    """Return what one part removes: nothing where the constant beside it says the same."""
    fine = among[0][0] > LAW_ALIKE * sizes[0]
    return np.where(fine, to_r[0] ** 2 / np.where(fine, among[0][0], 1.0), 0.0)


def _two(among: list[list[Floats]], to_r: list[Floats], sizes: list[Floats]) -> Floats:
    """Return what two parts together remove."""
    (a, b), (_, d) = among
    p, q = to_r
    determinant = a * d - b * b
    fine = determinant > LAW_ALIKE * sizes[0] * sizes[1]
    made = (d * p * p - 2 * b * p * q + a * q * q) / np.where(fine, determinant, 1.0)
    return np.where(fine, made, 0.0)
