"""Roots of many small matrices at once, by Cholesky, compiled by numba when first run.

A call of LAPACK for each costs more than its arithmetic, and a search asks for a hundred thousand.
Matrices stand one behind the other, row by row: matrix s has `counts[s]` rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.compiled import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def roots(matrices: Floats, counts: Ints) -> Floats:
    """Return the lower root of every matrix, flat; raises LinAlgError where one is not positive."""
    made = np.zeros(matrices.size)
    compiled(rooted)(matrices, counts, made)
    if np.isnan(made.sum()):
        raise np.linalg.LinAlgError("a matrix that is not positive")
    return made


def inverses(root: Floats, counts: Ints) -> Floats:
    """Return the inverse of every lower triangular matrix, flat."""
    made = root.copy()
    compiled(inverted)(made, counts)
    return made


def diagonals(counts: Ints) -> Ints:
    """Return where the diagonals of all matrices stand, one behind the other."""
    begin = np.cumsum(counts**2) - counts**2
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.asarray(np.repeat(begin, counts) + within * (np.repeat(counts, counts) + 1))


def rooted(matrices: Floats, counts: Ints, made: Floats) -> None:
    """Write lower roots to `made`; NaN where a matrix is not positive."""
    begin = 0
    for count in counts:
        given = matrices[begin : begin + count * count].reshape(count, count)
        root = made[begin : begin + count * count].reshape(count, count)
        begin += count * count
        for row in range(count):
            for column in range(row + 1):
                left = given[row, column]
                for before in range(column):
                    left -= root[row, before] * root[column, before]
                if column < row:
                    root[row, column] = left / root[column, column]
                else:
                    root[row, row] = np.sqrt(left) if left > 0 else np.nan


def inverted(made: Floats, counts: Ints) -> None:
    """Write the inverse of lower triangular matrices in their place, row by row."""
    begin = 0
    for count in counts:
        root = made[begin : begin + count * count].reshape(count, count)
        begin += count * count
        for row in range(count):
            come = np.zeros(row)
            for before in range(row):
                for column in range(before + 1):
                    come[column] += root[row, before] * root[before, column]
            root[row, row] = 1 / root[row, row]
            for column in range(row):
                root[row, column] = -come[column] * root[row, row]
