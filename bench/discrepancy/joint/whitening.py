"""What whitens every link's statistics, in one pass per link, compiled by numba when first run.

numpy's inverse takes a general matrix by elimination, and a fit asks for some ten thousand of these.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.cir_features import compiled

Floats = NDArray[np.float64]


def cholesky(covariance: Floats) -> tuple[Floats, float]:
    """Return the lower root [L, p, p] of each covariance, and their log volume.

    The volume is the sum of the logarithms of all determinants. Raises LinAlgError where a
    covariance is not positive.
    """
    made, volumes = np.zeros(covariance.shape), np.zeros(len(covariance))
    compiled(roots)(np.ascontiguousarray(covariance), made, volumes)
    if np.isnan(volumes).any():
        raise np.linalg.LinAlgError("a covariance that is not positive")
    return made, float(volumes.sum())


def inverted(root: Floats) -> Floats:
    """Return the inverses [L, p, p] of lower triangular matrices."""
    made = root.copy()
    compiled(inverses)(made)
    return made


def solved(root: Floats, values: Floats) -> Floats:
    """Return `values` [L, p], as the inverses of lower triangular matrices [L, p, p] whiten them."""
    made = np.array(values)
    compiled(forward)(root, made)
    return made


def roots(covariance: Floats, made: Floats, volumes: Floats) -> None:
    """Write lower Cholesky roots to `made` [L, p, p], and log determinants [L]; NaN if not any."""
    for link in range(covariance.shape[0]):
        root, given = made[link], covariance[link]
        for row in range(root.shape[0]):
            for column in range(row + 1):
                left = given[row, column]
                for before in range(column):
                    left -= root[row, before] * root[column, before]
                if column < row:
                    root[row, column] = left / root[column, column]
                else:
                    root[row, row] = np.sqrt(left) if left > 0 else np.nan
            volumes[link] += 2 * np.log(root[row, row])


def inverses(made: Floats) -> None:
    """Write the inverse of lower triangular matrices [L, p, p] in their place."""
    for link in range(made.shape[0]):
        root = made[link]
        for column in range(root.shape[0]):
            root[column, column] = 1 / root[column, column]
            for row in range(column + 1, root.shape[0]):
                left = 0.0
                for before in range(column, row):
                    left -= root[row, before] * root[before, column]
                root[row, column] = left / root[row, row]


def forward(root: Floats, made: Floats) -> None:
    """Write to `made` [L, p] what lower triangular matrices [L, p, p] take to what stands there."""
    for link in range(made.shape[0]):
        for row in range(made.shape[1]):
            left = made[link, row]
            for before in range(row):
                left -= root[link, row, before] * made[link, before]
            made[link, row] = left / root[link, row, row]
