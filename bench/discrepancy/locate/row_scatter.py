"""How far the rows of every link scatter about the mean of the link, in every version.

A deviation from the mean over versions tells nothing of scatter where there is one simulated
version: either is as far from it. The variance within a link is each version's own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.grouped import group_means, group_sums
from bench.discrepancy.data.observables import COUNT
from bench.discrepancy.settings import LEAST_ROW_SCATTER

Floats = NDArray[np.float64]


def row_scatter(ensemble: Ensemble) -> Floats:
    """Return the log of the variance of the rows of each link [1 + m, L, p].

    Of rows that all versions know, by the root of how many there are; 0 where that is one, and of
    counts of symbols: whole numbers that are mostly all one.
    """
    code = np.unique(ensemble.links, return_inverse=True)[1]
    known = np.isfinite(ensemble.versions).all(axis=0)
    count = group_sums(np.asarray(known, np.float64), code, int(code.max(initial=-1)) + 1)
    versions = np.where(known, ensemble.versions, np.nan)
    squares = [np.nan_to_num(one - group_means(one, code)) ** 2 for one in versions]
    variance = np.stack([group_sums(one, code, len(count)) for one in squares])
    variance /= np.maximum(count - 1, 1)
    least = LEAST_ROW_SCATTER * variance.mean(axis=(0, 1)) + ensemble.rounding**2
    least += np.finfo(np.float64).tiny
    weight = np.sqrt(np.maximum(count - 1, 0)) * [name != COUNT for name in ensemble.names]
    return np.asarray(weight * np.log(variance + least))


def about_links(values: Floats, links: NDArray[np.intp]) -> Floats:
    """Return how far values [..., n] are from the mean of their link, in their unit."""
    return np.asarray(np.abs(values - of_links(values, links)))


def of_links(values: Floats, links: NDArray[np.intp]) -> Floats:
    """Return the mean over the link of each of values [..., n], of those that are known."""
    code = np.unique(links, return_inverse=True)[1]
    means = group_means(values.reshape(-1, len(code)).T, code)
    return np.asarray(means.T.reshape(values.shape))
