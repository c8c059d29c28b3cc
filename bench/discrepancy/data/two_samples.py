"""Whether two samples are of one distribution."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def two_samples(one: Floats, other: Floats) -> tuple[float, float]:
    """Return the largest distance of two samples' distributions, and the chance of one as large.

    By the test of Kolmogorov and Smirnov, exact where that can be computed. Where it cannot scipy
    goes on with the asymptotic one and warns, which tells nobody anything here.
    """
    from scipy.stats import ks_2samp

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        found = ks_2samp(one, other)
    return float(found.statistic), float(found.pvalue)
