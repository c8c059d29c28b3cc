"""What whitens every link's statistics, in one pass per link."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.compiled import compiled
from bench.discrepancy.data.triangular import inverses, roots

Floats = NDArray[np.float64]


def cholesky(covariance: Floats) -> tuple[Floats, float]:
    """Return the lower root [L, p, p] of each covariance, and their log volume.

    The volume is the sum of the logarithms of all determinants. Raises LinAlgError where a
    covariance is not positive.
    """
    made = roots(covariance.ravel(), _counts(covariance)).reshape(covariance.shape)
    return made, 2 * float(np.log(np.einsum("lii->li", made)).sum())


def inverted(root: Floats) -> Floats:
    """Return the inverses [L, p, p] of lower triangular matrices."""
    return inverses(root.ravel(), _counts(root)).reshape(root.shape)


def solved(root: Floats, values: Floats) -> Floats:
    """Return `values` [L, p], whitened by the inverses of lower matrices [L, p, p]."""
    made = np.array(values)
    compiled(forward)(root, made)
    return made


def forward(root: Floats, made: Floats) -> None:
    """Write to `made` [L, p] what lower triangular matrices [L, p, p] take to what stands there."""
    for link in range(made.shape[0]):
        for row in range(made.shape[1]):
            left = made[link, row]
            for before in range(row):
                left -= root[link, row, before] * made[link, before]
            made[link, row] = left / root[link, row, row]


def _counts(matrices: Floats) -> NDArray[np.intp]:
    return np.full(len(matrices), matrices.shape[1])
