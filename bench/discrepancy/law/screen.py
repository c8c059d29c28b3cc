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
from bench.discrepancy.law.swift import swift

Floats = NDArray[np.float64]
Grids = dict[tuple[Form, int], Floats]
Scored = tuple[float, GridLaw]  # its gain in nats, complexity paid


@dataclass(frozen=True)
class _Screened:
    """A form over column `at` at screened constants `grid` [G], with sums that targets share.

    `among` are sums over rows [G, K] of products of its `parts`, per constant and factor; `means`
    of the parts themselves.
    """

    form: Form
    at: int
    grid: Floats
    parts: tuple[Floats, ...]
    among: list[list[Floats]]
    means: list[Floats]


def promising(given: Material, rows: float) -> list[GridLaw]:
    """Return the structures that remove most, complexity paid; `rows` count as independent.

    Residuals are taken once as they are and once cut, so that neither a few wild rows nor a
    law that moves few rows far is lost.
    """
    cut = LAW_CLIP * first_scale(given.residual_m)
    targets = given.residual_m, np.clip(given.residual_m, -cut, cut)
    grids, chosen = _grids(given), dict[tuple[object, ...], GridLaw]()
    for scored in _scored(given, grids, targets, rows):
        scored.sort(key=lambda one: -one[0])
        for _, law in scored[:LAW_REFINED]:
            chosen.setdefault((law.shape.text, law.at, law.by, law.offset), law)
    made = [_bracketed(law, grids[law.shape, law.at]) for law in chosen.values()]
    return [*made, *swift(given, targets[1], grids)]


def _grids(given: Material) -> Grids:
    """Return the constants that are screened [G] of every form over every column that can show."""
    pairs = [(CONSTANT, -1), *((form, at) for at in range(len(given.columns)) for form in FORMS)]
    grids = {(form, at): form.grid(over_what(given, at)) for form, at in pairs}
    return {pair: grid for pair, grid in grids.items() if len(grid)}


def _bracketed(law: GridLaw, grid: Floats) -> GridLaw:
    """Return the structure with the interval that its free constant is searched in."""
    return replace(law, bounds=law.shape.bounds(grid, law.value))


def _scored(
    given: Material, grids: Grids, targets: tuple[Floats, ...], rows: float
) -> list[list[Scored]]:
    """Return of every target [n] all structures at their best constants, with gains in nats."""
    weights = np.stack([factor.weights for factor in given.factors], axis=1)
    squared, out = weights**2, [list[Scored]() for _ in targets]
    for (form, at), grid in grids.items():
        one = _screened(given, form, at, grid, squared)
        for target, scored in zip(targets, out, strict=True):
            to_r = [(part * target) @ weights for part in one.parts]
            for offset in form.offset:
                removed = _removed(one, to_r, target @ weights, squared.sum(axis=0), offset)
                laws = _best(given, one, offset, removed, len(grids))
                total = float((target**2).sum())
                scored += [(_gain(r, total, rows) - cost(law, rows), law) for r, law in laws]
    return out


def _screened(given: Material, form: Form, at: int, grid: Floats, squared: Floats) -> _Screened:
    """Return a form over a column with the sums of its parts; `squared` weights [n, K]."""
    parts = form.basis(over_what(given, at), grid)
    among = [[(a * b) @ squared for b in parts] for a in parts]
    return _Screened(form, at, grid, parts, among, [part @ squared for part in parts])


def _best(
    given: Material, one: _Screened, offset: bool, removed: Floats, pairs: int
) -> Iterator[tuple[float, GridLaw]]:
    """Yield what a form with each factor removes [G, K] at its best constant, and that law."""
    best = removed.argmax(axis=0)
    for by in range(len(given.factors)):
        value = float(one.grid[best[by]])
        law = _law(given, one.form, one.at, by, offset, value, pairs)
        if law is not None:
            yield removed[best[by], by], law


def _gain(removed: float, total: float, rows: float) -> float:
    """Return the gain in nats of removing a part of a total sum of squares."""
    left = max(1 - removed / max(total, 1e-300), 1e-12)
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


def _removed(one: _Screened, to_r: list[Floats], of_r: Floats, own: Floats, offset: bool) -> Floats:
    """Return the sum of squares [G, K] that least squares removes, per free value and factor.

    `to_r` are sums of the parts times the target, `of_r` [K] of the target, `own` [K] of weights.
    """
    among, start = one.among, np.zeros(len(of_r))
    sizes = [row[i] for i, row in enumerate(among)]
    if offset:
        own, means = np.maximum(own, 1e-300), one.means
        to_r = [t - m * of_r / own for t, m in zip(to_r, means, strict=True)]
        among = [[v - a * b / own for v, b in zip(row, means)] for row, a in zip(among, means)]  # noqa: B905
        start = of_r**2 / own
    return start + (_one if len(one.parts) == 1 else _two)(among, to_r, sizes)


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
