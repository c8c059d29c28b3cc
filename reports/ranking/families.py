"""Every pair of models tested at once, so that one false difference in a table is a 5 % event.

The statistic of a pair is its mean difference over the cluster-robust standard error, links as
clusters. Its distribution where the two do not differ comes from flipping the sign of whole links
(the wild cluster bootstrap with the null imposed and Rademacher weights: Cameron, Gelbach and
Miller, Rev. Econ. Stat. 90, 2008), all pairs with the same signs. The family is controlled by the
step-down maximum of Romano and Wolf (Econometrica 73, 2005).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from reports.ranking.paired import Floats, Paired

LEVEL = 0.05
"""Chance of any false difference in one table."""
DRAWS = 4000
"""Sign patterns drawn; with 12 links or fewer every pattern is taken instead (2^12 = 4096)."""
POWER = 0.8
"""How often the smallest difference that is called detectable would be seen."""
ALIKE_M = 1e-4
"""Differences of less than 0.1 mm read alike in every table and are never told apart."""
_BLOCK = 500


@dataclass(frozen=True)
class Family:
    """Per pair of `paired.pairs`: difference, standard error, adjusted p, and whether it is real.

    `difference_m` = MAE(first) - MAE(second); `p` adjusted for the family (0 to 1); `apart` where
    p <= 5 % and the difference is at least 0.1 mm; `detectable_m` the difference that this data
    would show in 80 % of the cases.
    """

    paired: Paired
    difference_m: Floats
    error_m: Floats
    p: Floats
    apart: NDArray[np.bool_]
    detectable_m: Floats


def separate(paired: Paired, seed: int = 0) -> Family:
    """Test every pair of models. Raises ValueError for fewer than two models.

    With fewer than six links no pattern of signs is rare enough for 5 %: nothing is told apart.
    """
    if len(paired.names) < 2:
        raise ValueError("a comparison needs at least two models")
    difference = paired.gaps_m.sum(axis=1) / paired.rows.sum()
    statistic = _statistics(paired.gaps_m.sum(axis=1), _cross(paired), paired)
    drawn = np.concatenate(list(_null(paired, seed)))
    p = _stepdown(np.abs(statistic), np.abs(drawn))
    apart = (p <= LEVEL) & (np.abs(difference) >= ALIKE_M)
    error = _standard_errors(paired, difference)
    critical = float(np.quantile(np.abs(drawn).max(axis=1), 1 - LEVEL))
    return Family(
        paired, difference, error, p, apart, (critical + NormalDist().inv_cdf(POWER)) * error
    )


def _signs(links: int, seed: int) -> Floats:
    """Return sign patterns [patterns, links]: all of them, or a draw that holds the identity."""
    if 2**links <= DRAWS + 96:
        return np.array(list(product((1.0, -1.0), repeat=links)))
    drawn = np.random.default_rng(seed).integers(0, 2, (DRAWS, links)) * 2.0 - 1
    drawn[0] = 1  # what was seen is one of the patterns: p is never below 1 in DRAWS
    return np.asarray(drawn)


def _null(paired: Paired, seed: int) -> Iterator[Floats]:
    """Yield the statistics [patterns, pairs] under sign patterns, a block at a time."""
    signs = _signs(paired.links, seed)
    weighted = paired.gaps_m * paired.rows
    for start in range(0, len(signs), _BLOCK):
        block = signs[start : start + _BLOCK]
        yield _statistics(block @ paired.gaps_m.T, block @ weighted.T, paired)


def _cross(paired: Paired) -> Floats:
    return np.asarray((paired.gaps_m * paired.rows).sum(axis=1))


def _statistics(totals: Floats, cross: Floats, paired: Paired) -> Floats:
    """Return totals over their cluster-robust scale; 0 where a pair never differs.

    The scale is the root of the sum over links of (gap - mean difference x rows)^2.
    """
    mean = totals / paired.rows.sum()
    squares = (paired.gaps_m**2).sum(axis=1)
    around = squares - 2 * mean * cross + mean**2 * (paired.rows**2).sum()
    scale = np.sqrt(np.maximum(around, 1e-12 * np.maximum(squares, 1e-30)))
    return np.asarray(np.where(squares > 0, totals / scale, 0.0))


def _standard_errors(paired: Paired, difference: Floats) -> Floats:
    """Return the cluster-robust standard error of every difference in metres."""
    left = paired.gaps_m - difference[:, None] * paired.rows
    few = paired.links / max(paired.links - 1, 1)
    return np.asarray(np.sqrt(few * (left**2).sum(axis=1)) / paired.rows.sum())


def _stepdown(statistic: Floats, drawn: Floats) -> Floats:
    """Return the adjusted p of every pair: largest statistic first, each against what is left."""
    order = np.argsort(-statistic)
    # the maximum over this pair and all smaller ones, for every pattern
    largest = np.maximum.accumulate(drawn[:, order][:, ::-1], axis=1)[:, ::-1]
    p = (largest >= statistic[order] * (1 - 1e-9)).mean(axis=0)
    adjusted: Floats = np.empty(len(p))
    adjusted[order] = np.maximum.accumulate(p)
    return adjusted
