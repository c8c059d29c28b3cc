"""Means and spreads of every observable at every place: recorded against two simulators.

What a posterior predictive check looks at: see `adequacy`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats import t as student

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.settings import TIE
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.locate.hypotheses import Place
from bench.discrepancy.settings import (
    ADEQUACY_FIRST,
    ADEQUACY_INTERVALS,
    ADEQUACY_LEAST,
    ADEQUACY_MEMBERS,
    ADEQUACY_WIDEST,
    MAD_TO_STD,
    RESOLUTION,
)

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
Cells = tuple[Floats, Floats, Floats]
"""Response of an effect, what is left with it, what there was without it, each [C, p, 2]."""


def response_cells(
    whole: Ensemble, rest: Ensemble, weights: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the response, what is left, and what was left without the effect.

    In standard errors, all [C, p, 2]: of the mean, of the spread.
    """
    scale, links = _scales(whole, rest), whole.links
    after, before = _moments(whole, scale), _moments(rest, scale)
    simulated = np.stack([_link_sums(one, weights, links) for one in after[1:]])
    m = len(simulated)
    scatter = simulated.var(axis=0, ddof=1).sum(axis=0) * (1 + 1 / m)
    least = ADEQUACY_LEAST * (weights**2).sum(axis=0)[:, None, None]
    error = np.sqrt(scatter + least)
    left, without_it = (each[0] - each[1:].mean(axis=0) for each in (after, before))
    change = after[1:].mean(axis=0) - before[1:].mean(axis=0)
    change[..., 0] = np.nan_to_num(_clipped((_centre(whole) - _centre(rest)) / scale))
    sums = (_link_sums(each, weights, links).sum(axis=0) for each in (change, left, without_it))
    response, after_it, before_it = (np.abs(each) / error for each in sums)
    return response, after_it, before_it


def told_by_places(whole: Ensemble, rest: Ensemble, weights: Floats) -> Floats:
    """Return by how many standard errors what is left goes with every place [C, p, 2].

    The slope over a place's weights [n, C], beside a constant, with links as the unit (Liang and
    Zeger 1986): links that recordings leave off by chance, by more than simulated ones are, stand
    in some place or other.
    """
    after = _moments(whole, _scales(whole, rest))
    left = after[0] - after[1:].mean(axis=0)
    left = left - left.mean(axis=0)
    way = weights - weights.mean(axis=0)
    size = np.maximum((way**2).sum(axis=0), TIE)[:, None, None]
    slope = np.tensordot(way, left, axes=(0, 0)) / size
    squares = _link_sums(np.ones((len(way), 1, 1)), way**2, whole.links)
    sums = _link_sums(left, way, whole.links) - slope * squares
    links = len(sums)
    error = np.sqrt((sums**2).sum(axis=0) * links / max(links - 2, 1)) / size
    score = np.abs(slope) / np.maximum(error, TIE)
    return np.asarray(norm.isf(student.sf(score, max(links - 2, 1))))


def _moments(ensemble: Ensemble, scale: Floats) -> Floats:
    """Return every version around the simulated mean, and its size around its own mean.

    [1 + m, n, p, 2], in the `scale` [p] of the observables. A simulated version is part of the mean
    that it is taken from, the recorded is not: sizes are made equal.
    """
    m = len(ensemble.simulated)
    value = np.nan_to_num(_clipped((ensemble.versions - _centre(ensemble)) / scale))
    size = np.abs(value - value.mean(axis=1, keepdims=True))
    size[1:] *= np.sqrt((m + 1) / max(m - 1, 1))
    return np.stack([value, size], axis=-1)


def _clipped(value: Floats) -> Floats:
    return np.asarray(np.clip(value, -ADEQUACY_WIDEST, ADEQUACY_WIDEST))


def _link_sums(values: Floats, weights: Floats, links: Codes) -> Floats:
    """Return sums of weights [n, C] x values [n, p, 2] over the rows of each link [L, C, p, 2]."""
    order = np.argsort(links, kind="stable")
    bounds = np.flatnonzero(np.diff(links[order], prepend=-1))
    flat, weight = values[order].reshape(len(links), -1), weights[order]
    spans = zip(bounds, [*bounds[1:], len(links)], strict=True)
    made = np.stack([weight[a:b].T @ flat[a:b] for a, b in spans])
    return made.reshape(*made.shape[:2], *values.shape[1:])


def _centre(ensemble: Ensemble) -> Floats:
    """Return the ensemble's mean per row and observable [n, p]."""
    return np.asarray(ensemble.simulated.mean(axis=0))


def _scales(*ensembles: Ensemble) -> Floats:
    """Return the typical scatter of each observable [p], the largest of some ensembles."""
    units = ensembles[0].units
    least = np.array([RESOLUTION.get(unit, 0.0) for unit in units]) + TIE
    every = [np.abs(e.simulated - _centre(e)) for e in ensembles]
    found = [MAD_TO_STD * np.nanmedian(each, axis=(0, 1)) for each in every]
    return np.asarray(np.fmax(np.max(np.nan_to_num(found), axis=0), least))


def typical_size(cells: Floats) -> Floats:
    """Return the root mean square over places [p, 2], beyond what chance alone makes."""
    return np.asarray(np.sqrt(np.maximum((cells**2).mean(axis=0) - 1, 0)))


def fresh_ensemble(comparison: Comparison, views: tuple[View, ...], added: Added) -> Ensemble:
    """Return fresh replicates of the rows of all views as one ensemble."""
    made = [comparison.ensemble(v, added, ADEQUACY_MEMBERS, ADEQUACY_FIRST) for v in views]
    names = tuple(n for n in made[0].names if all(n in one.names for one in made))
    parts = [kept(one, names) for one in made]
    versions = np.concatenate([part.versions for part in parts], axis=1)
    links = np.concatenate([part.links for part in parts])
    return replace(parts[0], versions=versions, links=np.unique(links, return_inverse=True)[1])


def kept(ensemble: Ensemble, names: tuple[str, ...]) -> Ensemble:
    """Return the ensemble of some observables."""
    which = [ensemble.place(name) for name in names]
    units = tuple(ensemble.units[i] for i in which)
    return replace(ensemble, names=names, units=units, versions=ensemble.versions[..., which])


def predictive_places(views: tuple[View, ...]) -> Iterator[tuple[Place, Floats]]:
    """Yield places with the weights [n] of the rows of all views."""
    known = [view.covariates for view in views]
    rows = sum(len(view.rows) for view in views)
    yield Place(), np.ones(rows)
    for name in _shared([set(each.groups) for each in known]):
        mask = np.concatenate([each.groups[name] for each in known])
        yield Place(name), mask.astype(np.float64)
    for name in _shared([set(each.numbers) for each in known]):
        yield from _over(name, np.concatenate([each.numbers[name] for each in known]))


def _shared(names: list[set[str]]) -> list[str]:
    """Return the names that all have, in order."""
    return sorted(set.intersection(*names))


def _over(name: str, value: Floats) -> Iterator[tuple[Place, Floats]]:
    """Yield the trend over a number and its quantile intervals."""
    trend = Place(name, trend=True)
    yield trend, trend.weight(value)
    edges = np.unique(np.nanquantile(value, np.linspace(0, 1, ADEQUACY_INTERVALS + 1)))
    for low, high in pairwise(edges):
        place = Place(name, float(low), float(high))
        yield place, place.weight(value)


def place_weight(views: tuple[View, ...], place: Place) -> Floats | None:
    """Return the weight of all rows in a place [n], None where it is one of measured values."""
    if place.covariate is None:
        return np.ones(sum(len(view.rows) for view in views))
    known = [{**view.covariates.numbers, **view.covariates.groups} for view in views]
    if not all(place.covariate in each for each in known):
        return None
    return place.weight(np.concatenate([each[place.covariate] for each in known]))
