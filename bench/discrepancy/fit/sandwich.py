"""Intervals of fitted parameters: the sandwich of an M-estimator, with links as the unit.

The fit minimises f(theta) = sum over observables of weight x log(mean CRPS). Around its minimum
theta is normal with covariance H^-1 G H^-1, H the second derivative of f and G the sum over links
of the outer products of its per-link gradients (Huber 1967; White 1982). Derivatives are finite
differences on common random numbers; the finite ensemble adds 1/m of the variance.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from bench.discrepancy.compare.skill import Tally, tally, weight_of
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.fit.bootstrap import latent_intervals
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.search import revalued
from bench.discrepancy.fit.starts import by_level, free_parameters
from bench.discrepancy.settings import (
    AT_BOUND,
    FLAT_CURVATURE,
    FLAT_LOADING,
    INTERVAL_LEVEL,
    INTERVAL_MEMBERS,
    LEAST_CURVATURE,
    STEP_DB,
    STEP_OF_BOUNDS,
    STEP_OF_WAY,
    UNDETERMINED,
)
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]
PerLink = Callable[[Floats], Tally]
Intervals = Callable[[Comparison, View, Added, Effect], tuple[ParameterEstimate, ...]]


def parameter_intervals(
    comparison: Comparison, view: View, added: Added, effect: Effect
) -> tuple[ParameterEstimate, ...]:
    """Return every fitted parameter with its 90 % interval, from the rows it was fitted on."""
    if not effect.fitted:
        return latent_intervals(comparison, view, added, effect)
    free = tuple(p for p in free_parameters(type(effect)) if p.high > p.low)
    made = _intervals(comparison, view, added, effect, free)
    on = tuple(p for p in free if not off(effect, p))
    if len(on) == len(free) or all(one.determined for one in made if one.name in _names(on)):
        return made
    known = {one.name: one for one in _intervals(comparison, view, added, effect, on)}
    return tuple(known.get(one.name, one) for one in made)


def off(effect: Effect, item: Parameter) -> bool:
    """Return whether an effect does not do what it does only if asked, and so needs no value of it.

    A fit has left it out, as it gains nothing: a warm-up, that may stand in for a slope over a
    temperature which falls with the time.
    """
    return bool(item.default == item.null == getattr(effect, item.name))


def _names(items: tuple[Parameter, ...]) -> set[str]:
    return {item.name for item in items}


def _intervals(
    comparison: Comparison, view: View, added: Added, effect: Effect, moving: tuple[Parameter, ...]
) -> tuple[ParameterEstimate, ...]:
    """Return some parameters with their intervals, the others as they are."""
    values = np.array([float(getattr(effect, p.name)) for p in moving])
    steps = np.array([difference_step(p, v) for p, v in zip(moving, values, strict=True)])
    edges = np.array([(p.low, p.high) for p in moving]).reshape(-1, 2)
    centre = np.clip(values, edges[:, 0] + steps, edges[:, 1] - steps)

    def per_link(theta: Floats) -> Tally:
        inside = np.clip(theta, edges[:, 0], edges[:, 1])  # a sum may end just beyond a bound
        given = {p.name: float(v) for p, v in zip(moving, inside, strict=True)}
        changed = revalued(effect, given)
        return tally(comparison.ensemble(view, (*added, changed), INTERVAL_MEMBERS))

    errors = _standard_errors(per_link, centre, steps)
    links = len(np.unique(view.links))
    wide = float(student.ppf((1 + INTERVAL_LEVEL) / 2, max(links - 1, 1))) * np.sqrt(
        1 + 1 / INTERVAL_MEMBERS
    )
    return tuple(
        estimated(p, v, wide * e) for p, v, e in zip(moving, values.tolist(), errors, strict=True)
    )


def difference_step(item: Parameter, value: float) -> float:
    """Return the step of the differences, inwards where a bound is near."""
    if by_level(item):
        return STEP_DB
    size = max(
        abs(value - (item.null or 0.0)) * STEP_OF_WAY, (item.high - item.low) * STEP_OF_BOUNDS[0]
    )
    size = min(size, (item.high - item.low) * STEP_OF_BOUNDS[1])
    return float(size)


def estimated(item: Parameter, value: float, half: float) -> ParameterEstimate:
    """Return a parameter with its interval, cut at the physical bounds."""
    edge = AT_BOUND * (item.high - item.low)
    bound = value - item.low < edge or item.high - value < edge
    bound = bound and value != item.null
    half = half if np.isfinite(half) else item.high - item.low
    low, high = max(value - half, item.low), min(value + half, item.high)
    known = high - low < UNDETERMINED * (item.high - item.low)
    return ParameterEstimate(item.name, value, low, high, item.unit, bool(bound), bool(known))


def _standard_errors(per_link: PerLink, values: Floats, steps: Floats) -> Floats:
    """Return the standard error of each parameter (inf where the score is flat in it)."""
    centre = per_link(values)
    scale = _row_scale(centre)
    here = (centre.sums * scale).sum(axis=1)
    count = len(values)
    sides = [
        [_moved(per_link, values, steps, {i: s}, scale) for s in (1, -1)] for i in range(count)
    ]
    gradient = np.stack([(up - down) / 2 for up, down in sides], axis=1)
    hessian = np.empty((count, count))
    for i in range(count):
        hessian[i, i] = (sides[i][0] + sides[i][1] - 2 * here).sum()
        for j in range(i):
            cross = _moved(per_link, values, steps, {i: 1, j: 1}, scale).sum()
            mixed = cross - sides[i][0].sum() - sides[j][0].sum() + here.sum()
            hessian[i, j] = hessian[j, i] = mixed
    return _sandwich(hessian, gradient) * steps


def _row_scale(centre: Tally) -> Floats:
    """Return weight / (rows x mean CRPS) per observable: the linearised log score."""
    weights = np.array([weight_of(name) for name in centre.names])
    return np.asarray(weights / np.maximum(centre.sums.sum(axis=0), LEAST_CURVATURE))


def _moved(
    per_link: PerLink, values: Floats, steps: Floats, moves: dict[int, int], scale: Floats
) -> Floats:
    """Return the linearised score per link [L] with some parameters moved by their steps."""
    theta = values.copy()
    for i, sign in moves.items():
        theta[i] += sign * steps[i]
    return np.asarray((per_link(theta).sums * scale).sum(axis=1))


def _sandwich(hessian: Floats, gradient: Floats) -> Floats:
    """Return the square roots of the diagonal of H^-1 G H^-1, in steps."""
    rooted = np.linalg.eigh((hessian + hessian.T) / 2)
    flat = rooted.eigenvalues <= FLAT_CURVATURE * max(rooted.eigenvalues.max(), LEAST_CURVATURE)
    if flat.all():
        return np.full(len(hessian), np.inf)
    # Parameters along which the score is flat together are not determined one by one.
    loose = (rooted.eigenvectors[:, flat] ** 2).sum(axis=1) > FLAT_LOADING
    stiff = rooted.eigenvectors[:, ~flat]
    inverse = (stiff / rooted.eigenvalues[~flat]) @ stiff.T
    centred = gradient - gradient.mean(axis=0)
    links = len(gradient)
    spread = centred.T @ centred * links / max(links - 1, 1)
    errors = np.sqrt(np.maximum(np.diag(inverse @ spread @ inverse), 0))
    return np.where(loose, np.inf, errors)
