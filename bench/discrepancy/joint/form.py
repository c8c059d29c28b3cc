"""Whether a member of a set does no more than another form of a larger one would."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.select.deformation import within

Floats = NDArray[np.float64]


def of_form(given: Statistics, fit: Fit, name: str) -> bool:
    """Return whether a member does no more than another form of a larger one would.

    To means and to scatter, each by itself: no form of what moves means makes links scatter.
    """
    scatter = variances(given.needed(()))
    sizes = np.stack([_sizes(given, fit, place, scatter) for place in range(len(fit.names))])
    mine = np.array([one == name for one in fit.names])
    others, own = sizes[~mine], sizes[mine][0]
    louder = others[(others**2).sum(axis=(1, 2)) > (own**2).sum()]
    return bool(len(louder)) and within(own, louder)


def variances(moments: Moments) -> Floats:
    """Return the variance of every statistic [p], of links as simulated."""
    return np.asarray(np.diag(next(iter(moments.covariances.values()))))


def _sizes(given: Statistics, fit: Fit, place: int, scatter: Floats) -> Floats:
    """Return what a member does to means and to scatter [p, 2], in scatters without any."""
    rest = given.needed(fit.effects[:place] + fit.effects[place + 1 :])
    more = np.maximum(variances(fit.moments) - variances(rest), 0)
    means = (fit.responses[place] ** 2).mean(axis=0)
    return np.asarray(np.sqrt(np.stack([means, more], axis=1) / scatter[:, None]))
