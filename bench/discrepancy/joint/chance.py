"""What sets of effects say of simulated links in the recorded ones' place: what chance makes.

The likelihood takes statistics for normal. Where they are not - first paths found too early in a
few rows, weak taps that another effect buries - an effect may bring much though nothing is left
out. How much is seen on simulated links that nothing was left out of (a negative control: Lipsitch
et al. 2010), and how far these are from a set is how far the recorded ones may be (a posterior
predictive check: Gelman, Meng and Stern 1996).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from bench.discrepancy.joint.likelihood import evidence_of, misfits
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import MISFIT, MISFIT_FAR, MISFIT_SHARE, PREDICTED_P
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.settings import FEW_VERSIONS

Floats = NDArray[np.float64]


def off(given: Statistics, fit: Fit, none: Fit) -> bool:
    """Return whether recordings are farther from a set than its simulated links are.

    And by more than a small share of how far they are from `none`, but for what simulated links are
    off by chance: no form is exactly right.
    """
    moments, responses = fit.moments, fit.responses
    every = [misfits(given, replace(moments, left=o), responses) for o in given.others(fit.effects)]
    left, before = (misfits(given, one.moments, one.responses) for one in (fit, none))
    chance = float(np.mean([(one**2).mean() for one in every])) if every else 0.0
    beyond, most = (float((one**2).mean()) - chance for one in (left, before))
    farther = near(left) > max(MISFIT, highest([near(one) for one in every]))
    return farther and beyond > MISFIT_SHARE * most


def near(misfit: Floats) -> float:
    """Return the mean square of what is left [L, p], in scatters, far ones cut (Huber 1964).

    Where a weak first path is found early or late in a few rows, its figures are far off whatever
    set is right, and how often that happens is for a detector to say that nobody knows.
    """
    return float((np.clip(misfit, -MISFIT_FAR, MISFIT_FAR) ** 2).mean())


def by_chance(given: Statistics, fit: Fit, rest: Fit) -> float:
    """Return what a set may bring over the `rest` of it on simulated links, in nats.

    These have the rest in them, and not what the set has beside it: without the rest, a level
    control say, they would scatter otherwise than the rest has it, whatever more there is. 0 where
    it brings nothing.
    """
    more = (rest.moments.mean - fit.moments.mean)[given.code]
    every = given.others_rows(rest.effects)
    brought = [_of(given, fit, one + more) - _of(given, rest, one) for one in every]
    return max(0.0, highest(brought))


def highest(values: Sequence[float]) -> float:
    """Return what one more of normal values stays below (one-sided prediction bound), 0 of none."""
    if len(values) < FEW_VERSIONS:
        return 0.0
    wide = t.isf(PREDICTED_P, len(values) - 1) * np.sqrt(1 + 1 / len(values))
    return float(np.mean(values) + wide * np.std(values, ddof=1))


def _of(given: Statistics, fit: Fit, left: Floats) -> float:
    """Return the evidence of a set whose rows leave `left` [n, p], in nats."""
    rows = fit.moments.rows
    within = 0.0 if rows is None else given.within(left, rows, fit.moments.uneven_rows)
    moments: Moments = replace(fit.moments, left=given.of_links(left), within=within)
    return evidence_of(given, moments, fit.responses, fit.parameters)
