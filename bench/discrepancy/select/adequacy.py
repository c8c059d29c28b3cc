"""Whether a named effect, simulated at the recorded rows, reproduces what it acts on.

A score says that an effect helps; it does not say that recordings look like it. So before a name is
stated, the named effects are simulated once more (a posterior predictive check: Gelman, Meng and
Stern 1996), and means and spreads of every observable, in all rows, over groups and intervals of
every covariate and as trends, are compared with the recorded ones. What is left where an effect
acts must be small beside its own response there: library forms are never exactly right, so a share
of the response is allowed, chance too. A trend over a covariate that the effect does not depend on
is allowed less.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.hypotheses import Place
from bench.discrepancy.settings import (
    ADEQUACY_ALPHA,
    ADEQUACY_CUT,
    ADEQUACY_FIRST,
    ADEQUACY_INTERVALS,
    ADEQUACY_LEAST,
    ADEQUACY_LEFT,
    ADEQUACY_MEMBERS,
    ADEQUACY_OFF_COVARIATE,
    ADEQUACY_TOUCHED,
    ADEQUACY_WIDEST,
    MAD_TO_STD,
    RESOLUTION,
    TIE,
)
from bench.physics.effect import Effect

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True)
class Adequacy:
    """How much of the structure an effect acts on is left with it.

    `left` is what is left over the largest response of the effect in the same observable, `z` the
    same in standard errors, `where` the place and observable in words; `adequate` whether that
    may be chance or another form of the same effect. `note`: another reason why it is not.
    """

    adequate: bool
    left: float = 0.0
    z: float = 0.0
    where: str = ""
    note: str = ""

    def __str__(self) -> str:
        if self.note:
            return self.note
        return f"{self.left:.0%} of its response is left in {self.where} (z = {self.z:.1f})"


def adequacy(
    comparison: Comparison, views: tuple[View, ...], added: Added, effect: Effect
) -> Adequacy:
    """Return whether `added` reproduces, on the rows of `views`, what its `effect` acts on."""
    whole = _ensembles(comparison, views, added)
    rest = _ensembles(comparison, views, without(added, effect))
    names = tuple(n for n in whole.names if n in rest.names)
    if RANGE in names and not views[0].waveform:  # from paths alone levels are approximate
        names = (RANGE,)
    if not names:
        return Adequacy(True)
    places, weights = zip(*_places(views), strict=True)
    crowding = max(comparison.crowding(view) for view in views)
    return judged(_keep(whole, names), _keep(rest, names), places, np.stack(weights, 1), crowding)


def judged(
    whole: Ensemble, rest: Ensemble, places: tuple[Place, ...], weights: Floats, crowding: float
) -> Adequacy:
    """Return the adequacy of an effect that `whole` has and `rest` has not.

    Both are of the same rows and observables; `weights` [n, C] say which rows a place has. What
    the effect has cut down enough is not held against it: other causes may have left the rest.
    """
    response, left, before = _cells(whole, rest, weights)
    left = left / crowding
    own = response.max(axis=0)  # of each observable's mean and spread
    acts = own > ADEQUACY_TOUCHED * own.max(initial=0.0)
    beyond = norm.isf(ADEQUACY_ALPHA / 2 / max(left[:, acts].size, 1))
    seen = (left > beyond) & (left > ADEQUACY_CUT * before / crowding) & acts
    share = np.where(seen, left / np.maximum(own, 1.0), 0.0)
    here = response[:, acts].max(axis=1, initial=0.0)[:, None, None]
    allowed = np.where(left > here, ADEQUACY_OFF_COVARIATE, np.array(ADEQUACY_LEFT))
    worst = np.unravel_index(int((share / allowed).argmax()), share.shape)
    where = f"{('the mean', 'the spread')[worst[2]]} of {whole.names[worst[1]]} "
    where += places[worst[0]].where()
    figures = float(share[worst]), float(left[worst])
    return Adequacy(bool(share[worst] <= allowed[worst]), *figures, where)


def _cells(whole: Ensemble, rest: Ensemble, weights: Floats) -> tuple[Floats, Floats, Floats]:
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


def _ensembles(comparison: Comparison, views: tuple[View, ...], added: Added) -> Ensemble:
    """Return fresh replicates of the rows of all views as one ensemble."""
    made = [comparison.ensemble(v, added, ADEQUACY_MEMBERS, ADEQUACY_FIRST) for v in views]
    names = tuple(n for n in made[0].names if all(n in one.names for one in made))
    parts = [_keep(one, names) for one in made]
    versions = np.concatenate([part.versions for part in parts], axis=1)
    links = np.concatenate([part.links for part in parts])
    return replace(parts[0], versions=versions, links=np.unique(links, return_inverse=True)[1])


def _keep(ensemble: Ensemble, names: tuple[str, ...]) -> Ensemble:
    """Return the ensemble of some observables."""
    which = [ensemble.place(name) for name in names]
    units = tuple(ensemble.units[i] for i in which)
    return replace(ensemble, names=names, units=units, versions=ensemble.versions[..., which])


def _places(views: tuple[View, ...]) -> Iterator[tuple[Place, Floats]]:
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
