"""A piecewise-linear curve over one covariate, as parts that add up to it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.settings import UNNAMED_KNOTS

Floats = NDArray[np.float64]


def knots_of(values: Floats, most: int = UNNAMED_KNOTS) -> Floats:
    """Return the knots [k] of a curve over known values [n]: as many rows between any two.

    `most` of them; a single one, of a constant, is in the middle.
    """
    ends = np.linspace(0, 1, most) if most > 1 else np.array([0.5])
    return np.unique(np.quantile(values, ends))


def hats(values: Floats, knots: Floats) -> Floats:
    """Return the parts [n, k] of a curve: each 1 at its own knot, 0 at all others."""
    return np.stack([np.interp(values, knots, one) for one in np.eye(len(knots))], axis=1)
