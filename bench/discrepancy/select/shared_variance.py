"""What few versions of a link leave unknown of its scatter, other links tell.

Of three versions a standard deviation is known to a factor of two, and what is so little known is
beaten by nothing: with two degrees of freedom an offset of twenty scatters is no rarity. But links
scatter much alike. How much alike, all variances together tell (empirical Bayes: Smyth 2004,
"Linear models and empirical Bayes methods", sections 4 and 6.2): each is drawn towards the common
one, and known with as many more degrees of freedom.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import digamma, polygamma

from bench.discrepancy.select.settings import ALIKE_DEGREES

Floats = NDArray[np.float64]


def shared_variance(variance: Floats, degrees: int) -> tuple[Floats, float]:
    """Return the variances [L] that links have beside each other, and their degrees of freedom.

    Of variances [L] with so many `degrees` each. As they are where they have nothing in common.
    """
    known = variance[np.isfinite(variance) & (variance > 0)]
    if len(known) < 2:
        return variance, float(degrees)
    half = degrees / 2
    logs = np.log(known) - digamma(half) + np.log(half)
    more = _degrees_of(float(np.var(logs, ddof=1) - polygamma(1, half)))
    common = float(np.exp(logs.mean() + digamma(more / 2) - np.log(more / 2)))
    return (more * common + degrees * variance) / (more + degrees), degrees + more


def _degrees_of(scatter: float) -> float:
    """Return the degrees of freedom at which logarithms of variances scatter by a variance."""
    low, high = ALIKE_DEGREES
    if scatter <= polygamma(1, high / 2):
        return high
    if scatter >= polygamma(1, low / 2):
        return low
    return float(brentq(lambda d: polygamma(1, d / 2) - scatter, low, high))
