"""A free curve over one covariate: what the grammar lacks where it does much better than laws."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.data.piecewise import hats, knots_of
from bench.discrepancy.law.likelihood import linear
from bench.discrepancy.law.material import Column, Floats, Material
from bench.discrepancy.settings import UNNAMED_ROWS


def best_curve(given: Material) -> tuple[float, int]:
    """Return the log-likelihood of the best curve over one covariate, and its free values."""
    fits = [
        (linear(design, given.residual_m).likelihood, design.shape[1])
        for column in given.columns
        if len(given.residual_m) >= UNNAMED_ROWS and (design := _parts(column)) is not None
    ]
    return max(fits, default=(-np.inf, 0))


def _parts(column: Column) -> Floats | None:
    """Return the parts [n, knots] of a piecewise-linear curve; None over an angle."""
    knots = knots_of(column.values[np.isfinite(column.values)])
    if column.angle or len(knots) < 3:
        return None
    return np.nan_to_num(hats(column.values, knots))
