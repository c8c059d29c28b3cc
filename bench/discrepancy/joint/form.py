"""Whether a member of a set does no more than another form of a larger one would."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import SCATTERS
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.select.deformation import within

Floats = NDArray[np.float64]


def of_form(given: Statistics, fit: Fit, name: str) -> bool:
    """Return whether a member does no more than another form of a larger one would.

    To means and to scatter, each by itself: no form of what moves means makes links scatter.
    """
    sizes = _all_sizes(given, fit)
    own = sizes.pop(name)
    louder = [one for one in sizes.values() if (one**2).sum() > (own**2).sum()]
    return bool(louder) and within(own, np.stack(louder))


def beyond_forms(given: Statistics, fit: Fit, name: str) -> tuple[str, ...]:
    """Return the other members that do less than this one does, in most of what it does.

    Whatever their right forms are, they do not do what it does.
    """
    sizes = _all_sizes(given, fit)
    own = sizes.pop(name)
    return tuple(other for other, one in sizes.items() if not within(own, one[None], 1.0))


def scatters_more(fit: Fit, rest: Fit) -> bool:
    """Return whether links of a set scatter more than those of the rest of it.

    What is known should tell nothing of what scatters.
    """
    before, after = (variances(each.moments) for each in (rest, fit))
    return bool((after > SCATTERS * before).any())


def variances(moments: Moments) -> Floats:
    """Return the variance of every statistic [p], of links as simulated."""
    made = np.diag(next(iter(moments.covariances.values())))
    if moments.spared is None:
        return np.asarray(made)
    alone = float(moments.spared.alone.mean())
    others = np.diag(next(iter(moments.spared.covariances.values())))
    return np.asarray((1 - alone) * made + alone * others)


def _all_sizes(given: Statistics, fit: Fit) -> dict[str, Floats]:
    """Return what every member does to means and to scatter [p, 2], in scatters without any."""
    scatter = variances(given.needed(()))
    places = enumerate(fit.names)
    return {name: _sizes(given, fit, place, scatter) for place, name in places}


def _sizes(given: Statistics, fit: Fit, place: int, scatter: Floats) -> Floats:
    """Return what a member does to means and to scatter [p, 2], in scatters without any."""
    rest = given.needed(fit.effects[:place] + fit.effects[place + 1 :])
    more = np.maximum(variances(fit.moments) - variances(rest), 0)
    means = (fit.responses[place] ** 2).mean(axis=0)
    return np.asarray(np.sqrt(np.stack([means, more], axis=1) / scatter[:, None]))
