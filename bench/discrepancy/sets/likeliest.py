"""The sizes of causes of most evidence, sought for many sets of causes at once.

Thousands of sets are asked about, of a few columns each: calls cost more than their arithmetic. So
what is done column by column is done for all sets together; what a set gets does not depend on the
others.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dtrtri

from bench.discrepancy.sets.settings import EM_STEPS, LEAST_VARIANCE_M2, SIZE_BOUNDS

Floats = NDArray[np.float64]


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
    """Products of the columns of a set: `inner` [k, k] with each other, `right` [k] with the rest.

    `inner` in columns, as LAPACK has matrices.
    """

    inner: Floats
    right: Floats


def likeliest(
    forms: Sequence[Form], products: Sequence[Products], square: float, count: float
) -> list[tuple[Floats, float]]:
    """Return for each set the sizes [m] of its parts and the variance of rows, of most evidence.

    By expectation and maximisation; `square` is that of the residual, of `count` rows.
    """
    columns, parts = _slices(len(f.places) for f in forms), _slices(len(f.most) for f in forms)
    owner = np.concatenate([f.owner + part.start for f, part in zip(forms, parts, strict=True)])
    begin = np.concatenate([f.begin + own.start for f, own in zip(forms, columns, strict=True)])
    most = np.concatenate([form.most for form in forms])
    sizes, variances = np.ones(len(most)), [max(square / count, LEAST_VARIANCE_M2)] * len(forms)
    factors, own_squares = np.empty(len(owner)), np.empty(len(owner))
    each = list(zip(products, columns, parts, strict=True))
    for _ in range(EM_STEPS if len(owner) else 0):
        prior = (1 / sizes).take(owner)
        for (given, own, _), variance in zip(each, variances, strict=True):
            root = inverse_root(given.inner / variance, prior[own])
            factors[own] = root.T.dot(root.dot(given.right)) / variance
            own_squares[own] = np.einsum("ij,ij->j", root, root)
        told = np.maximum(np.add.reduceat(1 - own_squares * prior, begin), 1e-3)
        power = factors * factors
        sizes = np.add.reduceat(power, begin) / told
        sizes = np.minimum(np.maximum(sizes, SIZE_BOUNDS[0]), most)
        for number, (given, own, part) in enumerate(each):
            left = square - float(factors[own].dot(given.right))
            left -= variances[number] * float(power[own].dot(prior[own]))
            free = max(count - float(told[part].sum()), 1.0)
            variances[number] = max(left / free, LEAST_VARIANCE_M2)
    return [(sizes[part], variance) for part, variance in zip(parts, variances, strict=True)]


def _slices(lengths: Iterable[int]) -> list[slice]:
    """Return where each of several arrays is in all of them, one behind the other."""
    ends = [0, *accumulate(lengths)]
    return [slice(*pair) for pair in pairwise(ends)]


def inverse_root(matrix: Floats, more: Floats) -> Floats:
    """Return R [n, n], lower, with R' R the inverse of a matrix, `more` [n] on its diagonal.

    By Cholesky: a third of the work of an inverse by elimination. Raises LinAlgError where the sum
    is not positive. `matrix` stands in columns, and is written over.
    """
    if not len(more):
        return matrix
    assert matrix.flags.f_contiguous
    diagonal = matrix.T.ravel()[:: len(more) + 1]  # a view
    diagonal += more
    lower, wrong = dpotrf(matrix, lower=1, clean=1, overwrite_a=1)
    if wrong:
        raise np.linalg.LinAlgError("a precision that is not positive")
    return np.asarray(dtrtri(lower, lower=1, overwrite_c=1)[0])
