"""The same test rows under several models, summed by link: all that a comparison needs.

Rows of one link share their geometry, so a link is the unit of evidence. Every model is tested on
the same links, which makes differences between models far better known than the models' errors.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
RESAMPLES = 2000


@dataclass(frozen=True)
class Interval:
    """A figure with its 95 % interval; ends are None where the data allow none."""

    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Paired:
    """`names` [models]; `sums_m` [models, links] of |residual| in metres; `rows` [links]."""

    names: tuple[str, ...]
    sums_m: Floats
    rows: Floats

    @property
    def links(self) -> int:
        """How many links there are."""
        return len(self.rows)

    @cached_property
    def mae_m(self) -> Floats:
        """Mean |residual| over all rows [models], in metres."""
        return np.asarray(self.sums_m.sum(axis=1) / self.rows.sum())

    @cached_property
    def pairs(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Positions of the first and second model of every pair."""
        return np.triu_indices(len(self.names), 1)

    @cached_property
    def gaps_m(self) -> Floats:
        """Per pair and link, the first model's sum minus the second's [pairs, links]."""
        first, second = self.pairs
        return np.asarray(self.sums_m[first] - self.sums_m[second])

    def only(self, names: Sequence[str]) -> Paired:
        """Return these models alone, in this order."""
        chosen = [self.names.index(name) for name in names]
        return Paired(tuple(names), self.sums_m[chosen], self.rows)


def by_link(names: Sequence[str], residuals_m: Sequence[Floats], links: NDArray[np.str_]) -> Paired:
    """Return the sums over links of residuals [rows], one array per model; metres.

    Raises ValueError where a model's rows are not those of `links`.
    """
    _, group = np.unique(links, return_inverse=True)
    if any(len(one) != len(group) for one in residuals_m):
        raise ValueError("every model needs one residual per row")
    sums = [np.bincount(group, np.abs(one)) for one in residuals_m]
    return Paired(tuple(names), np.array(sums), np.bincount(group).astype(float))


def difference_m(paired: Paired, first: str, second: str, seed: int = 0) -> Interval:
    """Return MAE(first) - MAE(second) in metres with its 95 % interval.

    Bias-corrected and accelerated bootstrap over links (Efron, JASA 82, 1987); no interval with
    fewer than two links or where the two never differ. With ten links or fewer it is too short.
    """
    from scipy.stats import DegenerateDataWarning, bootstrap

    two = paired.only([first, second])
    gaps, value = two.gaps_m[0], float(two.mae_m[0] - two.mae_m[1])
    if two.links < 2 or not np.any(gaps):
        return Interval(value)
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", DegenerateDataWarning)  # no interval says so too
        found = bootstrap(
            (gaps, two.rows),
            lambda gap, rows, axis: gap.sum(axis=axis) / rows.sum(axis=axis),
            n_resamples=RESAMPLES,
            paired=True,
            vectorized=True,
            rng=np.random.default_rng(seed),
        )
    low, high = map(float, found.confidence_interval)
    return Interval(value, low, high) if np.isfinite([low, high]).all() else Interval(value)
