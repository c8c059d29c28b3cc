"""The sizes of causes of most evidence, sought for many sets of causes at once.

Thousands of sets are asked about, of a few columns each: calls cost more than their arithmetic. So
what is done column by column is done for all sets together; what a set gets does not depend on the
others.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bench.compiled import compiled
from bench.discrepancy.data.triangular import diagonals, inverses, roots
from bench.discrepancy.sets.settings import EM_STEPS, LEAST_VARIANCE_M2, SIZE_BOUNDS

Floats = NDArray[np.float64]
T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True)
class Form:
    """What a set of `causes` is made of: columns `places` [k], in parts of one size each.

    `owner` [k]: the part of every column; `begin` [m]: where each begins; `most` [m]: the largest
    variance of its factors.
    """

    causes: tuple[str, ...]
    places: NDArray[np.intp]
    owner: NDArray[np.intp]
    begin: NDArray[np.intp]
    most: Floats


@dataclass(frozen=True)
class Products:
    """Products of a set's columns: `inner` [k, k] with each other, `right` [k] with the rest."""

    inner: Floats
    right: Floats


class _Every:
    """The columns of all sets, one set behind the other: what is worked out of them in one go."""

    def __init__(self, products: Sequence[Products]) -> None:
        self.inner = _joined(p.inner.ravel() for p in products)
        self.right = _joined(p.right for p in products)
        self.counts = np.array([len(p.right) for p in products], np.intp)
        self.owner = np.repeat(np.arange(len(products)), self.counts)
        self._entries = np.repeat(np.arange(len(products)), self.counts**2)
        self._diagonals = diagonals(self.counts)

    def expected(self, prior: Floats, variances: Floats) -> tuple[Floats, Floats]:
        """Return the likeliest factors [c] of all columns, and the squares [c] of their errors."""
        matrices = self.inner / variances.take(self._entries)
        matrices[self._diagonals] += prior
        root = inverses(roots(matrices, self.counts), self.counts)
        factors, spreads = np.zeros(len(prior)), np.zeros(len(prior))
        compiled(summed)(root, self.right, self.counts, factors, spreads)
        return factors / variances.take(self.owner), spreads

    def sums(self, values: Floats) -> Floats:
        """Return the sum of values [c] of columns over every set."""
        return np.asarray(np.bincount(self.owner, values, len(self.counts)), np.float64)


def likeliest(
    forms: Sequence[Form], products: Sequence[Products], square: float, count: float
) -> list[tuple[Floats, float]]:
    """Return for each set the sizes [m] of its parts and the variance of rows, of most evidence.

    By expectation and maximisation; `square` is that of the residual, of `count` rows.
    """
    sets, most = _Every(products), _joined(form.most for form in forms)
    parts, columns = _ends(len(f.most) for f in forms), _ends(len(f.places) for f in forms)
    owner = _joined(f.owner + at for f, at in zip(forms, parts, strict=False))
    begin = _joined(f.begin + at for f, at in zip(forms, columns, strict=False))
    of_part = np.repeat(np.arange(len(forms)), np.diff(parts))
    sizes = np.ones(len(most))
    variances = np.full(len(forms), max(square / count, LEAST_VARIANCE_M2))
    for _ in range(EM_STEPS if len(owner) else 0):
        prior = (1 / sizes).take(owner)
        factors, spreads = sets.expected(prior, variances)
        told = np.maximum(np.add.reduceat(1 - spreads * prior, begin), 1e-3)
        power = factors * factors
        sizes = np.add.reduceat(power, begin) / told
        sizes = np.minimum(np.maximum(sizes, SIZE_BOUNDS[0]), most)
        left = square - sets.sums(factors * sets.right) - variances * sets.sums(power * prior)
        free = np.maximum(count - np.bincount(of_part, told, len(forms)), 1.0)
        variances = np.maximum(left / free, LEAST_VARIANCE_M2)
    ends = zip(pairwise(parts), variances.tolist(), strict=True)
    return [(sizes[slice(*part)], variance) for part, variance in ends]


def _ends(lengths: Iterable[int]) -> NDArray[np.intp]:
    """Return where each of several arrays begins in all of them, and where the last ends."""
    return np.array([0, *accumulate(lengths)], np.intp)


def _joined(parts: Iterable[NDArray[T]]) -> NDArray[T]:
    """Return arrays, one behind the other."""
    return np.concatenate([*parts])


def summed(
    root: Floats, right: Floats, counts: NDArray[np.intp], along: Floats, out: Floats
) -> None:
    """Write R' R `right` of every set to `along` [c], and what is squared in columns of R."""
    begin = first = 0
    for count in counts:
        given = root[begin : begin + count * count].reshape(count, count)
        for row in range(count):
            one = 0.0
            for column in range(row + 1):
                one += given[row, column] * right[first + column]
            for column in range(row + 1):
                along[first + column] += given[row, column] * one
                out[first + column] += given[row, column] * given[row, column]
        begin, first = begin + count * count, first + count


def inverse_root(matrix: Floats, more: Floats) -> Floats:
    """Return R [n, n], lower, with R' R the inverse of a matrix, `more` [n] on its diagonal.

    Raises LinAlgError where the sum is not positive.
    """
    count = np.array([len(more)])
    whole = (matrix + np.diag(more)).ravel()
    return inverses(roots(whole, count), count).reshape(matrix.shape)
