"""Intervals with what is not known of other causes: beside them an effect may do something else.

The interval of a parameter, as rows give it with all others known, is wider by what the joint fit
of a set leaves more open: a variance beside it, of rows that scatter as much as that interval says.
What no row tells is as open as it was before, however much these scatter. The interval holds 90 %
over all the sets that may be there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import norm

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.fit.bootstrap import ESTIMATORS, latent_values
from bench.discrepancy.fit.estimate import ParameterEstimate, within_bounds
from bench.discrepancy.fit.sandwich import difference_step, off
from bench.discrepancy.fit.search import revalued
from bench.discrepancy.sets.believed import Believed, Unsure
from bench.discrepancy.sets.settings import OWN_SHARE
from bench.discrepancy.settings import (
    INTERVAL_LEVEL,
    LEAST_CURVATURE,
    MOVED_M,
    RESIDUAL_MEMBERS,
    UNDETERMINED,
)
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]
Estimates = tuple[ParameterEstimate, ...]
Does = Callable[[Effect], Floats]
"""What an effect does to the range of every row [n], in metres."""
TAILS = ((1 - INTERVAL_LEVEL) / 2, (1 + INTERVAL_LEVEL) / 2)
QUANTILE = float(norm.ppf((1 + INTERVAL_LEVEL) / 2))


def with_doubt(
    comparison: Comparison,
    view: View,
    others: Added,
    effect: Effect,
    intervals: Estimates,
    known: Unsure,
) -> Estimates:
    """Return the intervals of an effect beside `others` with what sets leave open of it."""

    def does(one: Effect) -> Floats:
        return _change_m(comparison, view, others, one)

    intervals = _told_by_sets(effect, does, intervals, known)
    ways = _moved_by(view, effect, does, known, intervals)
    every = known.columns.T @ known.columns
    out = []
    for one in intervals:
        way = ways.get(one.name)
        made = _of_rows(one, every, known) if way is None else _of_sets(one, way, known)
        out.append(within_bounds(made, effect))
    return tuple(out)


def _told_by_sets(effect: Effect, does: Does, intervals: Estimates, known: Unsure) -> Estimates:
    """Return the intervals, of values that a score leaves open as wide as a set of causes knows.

    Of few simulated rows a score is too rough to say how fast it falls beside a small value: it is
    bent at every one of them. Not of what others of the same effect can do as well, nor of what it
    does not do.
    """
    items = {item.name: item for item in type(effect).parameters()}
    some = [one for one in intervals if one.name in items and not off(effect, items[one.name])]
    if type(effect) in ESTIMATORS or all(one.determined for one in some):
        return intervals
    every = tuple(replace(one, determined=True) for one in some)
    ways = _of_parameters(effect, does, known.columns, every)
    apart = _apart(effect, does, every) if ways else set()
    return tuple(
        one
        if one.determined or one.name not in apart
        else _alone(items[one.name], one, ways[one.name], known)
        for one in intervals
    )


def _alone(
    item: Parameter, one: ParameterEstimate, way: Floats, known: Unsure
) -> ParameterEstimate:
    """Return the interval of a value that changes so with the factors [k] of the joint fit."""
    half = QUANTILE * float(np.sqrt(way @ known.alone.covariance() @ way))
    told = 2 * half < UNDETERMINED * (item.high - item.low)
    return replace(one, low=one.value - half, high=one.value + half, determined=told)


def _apart(effect: Effect, does: Does, every: Estimates) -> set[str]:
    """Return the values of an effect that do what no others of it do."""
    slopes = _slopes(effect, does, every)
    out = set()
    for name, slope in slopes.items():
        rest = [other for one, other in slopes.items() if one != name]
        left = slope
        if rest:
            design = np.stack(rest, axis=1)
            left = rest_of(slope, design)
        if float((left**2).sum()) > OWN_SHARE * float((slope**2).sum()):
            out.add(name)
    return out


def _of_rows(one: ParameterEstimate, every: Floats, known: Unsure) -> ParameterEstimate:
    """Return the interval of a value of which nobody knows how it goes with what an effect does.

    As many times wider as that is less known, over all rows.
    """
    both, alone = (float(np.sum(every * one.covariance())) for one in (known.sets[0], known.alone))
    times = np.sqrt(both / max(alone, LEAST_CURVATURE))
    below, above = one.value - one.low, one.high - one.value
    return replace(one, low=one.value - times * below, high=one.value + times * above)


def _of_sets(one: ParameterEstimate, way: Floats, known: Unsure) -> ParameterEstimate:
    """Return the interval of a value that changes so with the factors [k] of an effect."""
    own = (max(one.value - one.low, one.high - one.value) / QUANTILE) ** 2
    wide = [float(np.sqrt(own + more)) for more in _more(own, way, known)]
    first = known.sets[0].factors
    middle = [one.value + float(way @ (made.factors - first)) for made in known.sets]
    share = [made.share for made in known.sets]
    low, high = (_quantile(p, middle, wide, share) for p in TAILS)
    return replace(one, low=min(low, one.value), high=max(high, one.value))


def _more(own: float, way: Floats, known: Unsure) -> list[float]:
    """Return the variance that every set leaves open more than if all others of it were known.

    `own` is that of the rows. Where it is larger than a set has it, rows tell so much less (few
    simulated ones stand for them, or no form is right): of what others do, too.
    """

    def variance(said: Believed, noise: float) -> float:
        return float(way @ said.covariance(noise) @ way)

    alone = variance(known.alone, 1.0)
    noise = max(own / alone, 1.0) if alone > 0 else 1.0
    known_then = variance(known.alone, noise)
    return [max(variance(made, noise) - known_then, 0.0) for made in known.sets]


def _quantile(p: float, middle: list[float], wide: list[float], share: list[float]) -> float:
    """Return a quantile of a mixture of normal distributions."""
    ends = [m + s * float(norm.ppf(p)) for m, s in zip(middle, wide, strict=True)]
    if max(ends) - min(ends) <= 0:
        return ends[0]

    def beyond(x: float) -> float:
        below = norm.cdf((x - np.array(middle)) / np.array(wide))
        return float(np.array(share) @ below) - p

    return float(brentq(beyond, min(ends), max(ends)))


def _moved_by(
    view: View, effect: Effect, does: Does, known: Unsure, intervals: Estimates
) -> dict[str, Floats]:
    """Return how much each value of an effect changes with the factors [k] of a set.

    To first order, of a fit by least squares; of values that are estimated in another way between
    one standard deviation below and above, along every axis of what the set knows: which device a
    constant is taken from changes with the constant.
    """
    if type(effect) not in ESTIMATORS:
        return _of_parameters(effect, does, known.columns, intervals)
    latent = latent_values(view, effect)
    assert latent is not None
    names, _, values = latent
    squares, axes = np.linalg.eigh(known.sets[0].covariance())
    steps = np.sqrt(np.maximum(squares, LEAST_CURVATURE))
    every, now = np.arange(len(known.columns)), does(effect)
    ends = [
        [values(every, now + sign * one, False) for sign in (1, -1)]
        for one in (known.columns @ (axes * steps)).T
    ]
    moved = np.array([(above - below) / 2 for above, below in ends])
    ways = axes @ (moved / steps[:, None])
    return {n: way for n, way in zip(names, ways.T, strict=True) if np.isfinite(way).all()}


def _of_parameters(
    effect: Effect, does: Does, shifts_m: Floats, intervals: Estimates
) -> dict[str, Floats]:
    """Return the same for parameters of the library's effects, those that are determined."""
    slopes = _slopes(effect, does, intervals)
    if not slopes:
        return {}
    ways = np.linalg.lstsq(np.stack(list(slopes.values()), axis=1), shifts_m, rcond=None)[0]
    return dict(zip(slopes, ways, strict=True))


def _slopes(effect: Effect, does: Does, intervals: Estimates) -> dict[str, Floats]:
    """Return what an effect does more to every row [n] per unit of its determined parameters."""
    items = {item.name: item for item in type(effect).parameters()}
    slopes = {}
    for one in (i for i in intervals if i.name in items and i.determined):
        item = items[one.name]
        step = difference_step(item, one.value)
        ends = np.clip([one.value - step, one.value + step], item.low, item.high)
        low, high = (does(revalued(effect, {one.name: float(end)})) for end in ends)
        if np.abs(high - low).max() > MOVED_M:
            slopes[one.name] = (high - low) / (ends[1] - ends[0])
    return slopes


def _change_m(comparison: Comparison, view: View, others: Added, effect: Effect) -> Floats:
    """Return what an effect does to the mean simulated range of every row [n], in metres."""
    made, bare = (
        comparison.ensemble(view, added, RESIDUAL_MEMBERS).simulated_of(RANGE).mean(axis=0)
        for added in ((*others, effect), others)
    )
    return np.asarray(np.nan_to_num(made - bare))
