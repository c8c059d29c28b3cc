"""How sure the sizes of waveform effects are: of all parameters of a set at once.

The covariance of parameters that were fitted together is a sandwich with links as the unit (Huber
1967; White 1982), with the slopes and weights of the fit. That a parameter lies within its bounds
is known before: where others that do the same leave a wide valley, its bounds end it, and what is
as wide as the bounds is not determined. Nor is what phases alone tell: powers are compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.sandwich import Intervals, parameter_intervals
from bench.discrepancy.fit.starts import between, free_parameters
from bench.discrepancy.joint.polish import Fit, at_work, fitted, shares, slopes_of
from bench.discrepancy.joint.rows import compared_rows
from bench.discrepancy.joint.settings import (
    BOUNDS_INFORMATION,
    LONGEST_STEP,
    SIZE_MEMBERS,
    SIZE_STEP,
    SIZE_WIDER,
)
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import AT_BOUND, INTERVAL_LEVEL, UNDETERMINED
from bench.errors import BenchError
from bench.physics.effect import Effect, Parameter
from bench.physics.effects.receiver.quantisation import OnGrid

Floats = NDArray[np.float64]
Estimates = tuple[ParameterEstimate, ...]


@dataclass(frozen=True)
class Sizes:
    """Intervals of the effects of sets, as waveforms of some rows see them.

    Of effects on ranges alone, which these do not see, as `parameter_intervals` gives them.
    """

    given: Statistics

    def __call__(
        self, comparison: Comparison, view: View, others: Added, effect: Effect
    ) -> Estimates:
        """Return every fitted parameter of an effect beside `others` with its 90 % interval."""
        if not on_waveforms(effect):
            return parameter_intervals(comparison, view, others, effect)
        among = [one for one in (*others, effect) if on_waveforms(one)]
        now = fitted(self.given, tuple(sorted(among, key=lambda one: one.name)))
        if now is None:
            return ()
        whose = np.repeat(now.names, [len(free_parameters(type(one))) for one in now.effects])
        return estimates(effect, reaches(self.given, now)[:, whose == effect.name])


def sizes_seen(search: Search) -> Intervals:
    """Return how intervals of a search are found: from waveforms, where these can be compared."""
    try:
        rows = compared_rows(search)
        return Sizes(Statistics(search.comparison, rows, members=SIZE_MEMBERS))
    except BenchError:
        return parameter_intervals


def on_waveforms(effect: Effect) -> bool:
    """Return whether an effect is one of those that waveforms are fitted with."""
    return type(effect).stage != "ranging" and bool(free_parameters(type(effect)))


def reaches(given: Statistics, now: Fit) -> Floats:
    """Return how far below and above every parameter is unsure, in shares of its bounds [2, k].

    Both with 90 %, from where the fit is and from where one more step would take it.
    """
    here, ways = at_work(given, now, both_ways(given, now))
    known = BOUNDS_INFORMATION * np.eye(len(ways))
    inverse = np.linalg.inv(np.einsum("klp,mlp->km", ways, ways) + known)
    scores = np.einsum("klp,lp->lk", ways, here)
    step = np.clip(-inverse @ scores.sum(axis=0), -LONGEST_STEP, LONGEST_STEP)
    scores = scores - scores.mean(axis=0)
    spread = scores.T @ scores * given.crowding * given.links / max(given.links - 1, 1)
    half = _wide(given.links) * np.sqrt(np.diag(inverse @ (spread + known) @ inverse))
    return SIZE_WIDER * np.stack([half + np.maximum(-step, 0), half + np.maximum(step, 0)])


def both_ways(given: Statistics, now: Fit) -> Floats:
    """Return the slopes [L, 3 p, k] as means of both ways, far enough that noise is little."""
    return (slopes_of(given, now, SIZE_STEP) + slopes_of(given, now, -SIZE_STEP)) / 2


def _wide(links: int) -> float:
    """Return how many standard errors half an interval is."""
    return float(student.ppf((1 + INTERVAL_LEVEL) / 2, max(links - 1, 1)))


def estimates(effect: Effect, reach: Floats) -> Estimates:
    """Return the parameters of an effect with intervals that reach so far [2, k], cut at bounds.

    The step of a grid was read off samples, and is known.
    """
    free, at = free_parameters(type(effect)), shares((effect,))
    ends = np.clip([at - reach[0], at + reach[1]], 0, 1).T.tolist()
    fitted_ones = (_estimate(effect, *each) for each in zip(free, ends, at.tolist(), strict=True))
    return (*_read_off(effect), *fitted_ones)


def _read_off(effect: Effect) -> Estimates:
    """Return the step of a grid that samples lie on, none of other effects."""
    if not isinstance(effect, OnGrid):
        return ()
    step = float(effect.step_counts)
    return (ParameterEstimate("step_counts", step, step, step, "counts"),)


def _estimate(
    effect: Effect, item: Parameter, ends: Sequence[float], share: float
) -> ParameterEstimate:
    low, high = (between(item, item.low, item.high, end) for end in ends)
    value = float(getattr(effect, item.name))
    bound = min(share, 1 - share) < AT_BOUND and value != item.null
    known = ends[1] - ends[0] < UNDETERMINED and item.name not in type(effect).of_phases
    return ParameterEstimate(item.name, value, low, high, item.unit, bound, known)
