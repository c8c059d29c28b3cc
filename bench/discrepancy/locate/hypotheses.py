"""The places a search looks at, and the sums over links that its statistic is made of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.settings import CLIP_STD, INTERVAL_COUNTS, TAIL_SHARE

Floats = NDArray[np.float64]
Links = NDArray[np.intp]
Moment = Literal["mean", "spread", "link", "slope", "rows"]
OWN = ("rx_power_dbm", "first_path_power_dbm")  # observables that others are searched against


def between(low: float, high: float) -> str:
    """Return an interval in words, with as many digits as tell its ends apart.

    >>> between(0.5, 2.0), between(0.00112801, 0.00112834)
    ('0.5 to 2', '0.001128 to 0.0011283')
    """
    for digits in range(4, 12):
        words = f"{low:.{digits}g}", f"{high:.{digits}g}"
        if words[0] != words[1]:
            break
    return " to ".join(words)


@dataclass(frozen=True)
class Place:
    """Rows to look at: all, a group, an interval of a number, or the trend over a number."""

    covariate: str | None = None
    low: float | None = None
    high: float | None = None
    trend: bool = False

    def where(self) -> str:
        """Return the rows in words."""
        if self.covariate is None:
            return "in all rows"
        if self.trend:
            return f"as a trend over {self.covariate}"
        if self.low is None or self.high is None:
            return f"where {self.covariate}"
        return f"where {self.covariate} is {between(self.low, self.high)}"

    def weight(self, value: Floats | NDArray[np.bool_]) -> Floats:
        """Return the weight of each row, 0/1 or the standardised trend; same shape as `value`."""
        number = np.asarray(value, np.float64)
        if self.covariate is None:
            return np.ones_like(number)
        if self.trend:
            return np.nan_to_num((number - np.nanmean(number)) / (np.nanstd(number) or 1.0))
        if self.low is None or self.high is None:
            return number
        return ((number >= self.low) & (number <= self.high)).astype(np.float64)


@dataclass(frozen=True)
class Cell:
    """One thing compared: a moment of an observable at a place."""

    observable: str
    moment: Moment
    place: Place


def places(covariates: Covariates, ensemble: Ensemble) -> Iterator[tuple[Place, Floats]]:
    """Yield every place with its row weights, [n], or [1 + m, n] where they are the row's own.

    Of an observable that is among the covariates, rows have those values in all versions. An
    interval that holds the rows of a group is that group: an anchor, and not its height.
    """
    yield Place(), np.ones(len(ensemble.links))
    for name, mask in covariates.groups.items():
        yield Place(name), mask.astype(np.float64)
    groups = {mask.tobytes() for mask in covariates.groups.values()}
    for name, value in covariates.numbers.items():
        every = _intervals(name, value)
        yield from (one for one in every if one[0].trend or (one[1] > 0).tobytes() not in groups)
    for name in OWN:
        if name in ensemble.names and name not in covariates.numbers:
            yield from _intervals(name, ensemble.versions_of(name))


def _intervals(name: str, value: Floats) -> Iterator[tuple[Place, Floats]]:
    """Yield quantile intervals of a number, its two tails, and its trend."""
    known = value[np.isfinite(value)]
    if not len(known) or known.max() <= known.min():
        return
    tails = np.quantile(known, [0.0, TAIL_SHARE, 1 - TAIL_SHARE, 1.0])
    pairs = [(tails[0], tails[1]), (tails[2], tails[3])]
    for bins in INTERVAL_COUNTS:
        edges = np.unique(np.quantile(known, np.linspace(0, 1, bins + 1)))
        pairs += list(pairwise(edges)) if len(edges) > 2 else []
    for low, high in pairs:
        place = Place(name, float(low), float(high))
        weight = place.weight(value)
        if 0 < weight.mean() < 1:
            yield place, weight
    place = Place(name, trend=True)
    yield place, place.weight(value)


def standardised(ensemble: Ensemble) -> NDArray[np.float32]:
    """Return versions centred on their own mean, scaled per observable, clipped; NaN as 0.

    Centre and scale are symmetric in the versions, as the permutation needs. [1 + m, n, p]. What a
    constant is off its mean by is rounding, and nothing.
    """
    centred = ensemble.versions - ensemble.versions.mean(axis=0)
    centred = np.where(np.abs(centred) <= ensemble.rounding, 0.0, centred)
    typical = np.nanmean(np.median(centred**2, axis=0), axis=0)
    whole = np.nanmean(centred**2, axis=(0, 1))
    scale = np.sqrt(np.where(typical > 0, typical, whole + 1e-30))
    return np.asarray(np.clip(np.nan_to_num(centred / scale), -CLIP_STD, CLIP_STD), np.float32)


def link_sums(
    ensemble: Ensemble,
    covariates: Covariates,
    clusters: Sequence[Links] | None = None,
    scatter: Floats | None = None,
) -> tuple[list[Cell], NDArray[np.float32]]:
    """Return the cells and their statistic per version and link, [1 + m, L, K].

    With `clusters` (numbers 0..L-1 of links) it is per version and cluster, [1 + m, C, K]: only one
    cluster's links are held at a time, because those of thousands of links take gigabytes. Every
    statistic is centred over the versions, so its mean under the permutation is zero. `scatter`
    [1 + m, L, p]: how rows scatter within links, of which there are cells then (see `row_scatter`).
    """
    found = list(places(covariates, ensemble))
    shared = [(place, weight) for place, weight in found if weight.ndim == 1]
    own = [(place, weight) for place, weight in found if weight.ndim == 2]
    groups = [_group(ensemble, group) for group in (shared, own) if group]
    cells = [cell for group in groups for cell in group.cells]
    within = np.zeros((len(ensemble.versions), groups[0].links, 0), np.float32)
    if scatter is not None:
        cells += [Cell(name, "rows", Place()) for name in ensemble.names]
        within = (scatter - scatter.mean(axis=0)).astype(np.float32)

    def sums(links: Links) -> NDArray[np.float32]:
        return np.concatenate([*(g.sums(links) for g in groups), within[:, links]], axis=2)

    # The order in memory decides in which order sums over versions are rounded: keep it.
    if clusters is None:
        whole = np.ascontiguousarray(np.moveaxis(sums(np.arange(groups[0].links)), 2, 0))
        return cells, np.moveaxis(whole, 0, 2)
    added = [np.add.reduceat(sums(links), [0], axis=1)[:, 0] for links in clusters]
    return cells, np.moveaxis(np.stack([np.ascontiguousarray(part.T) for part in added]), 2, 0)


@dataclass(frozen=True)
class _Group:
    """Places whose weights have one shape, with their rows in the order of links.

    `values` [1 + m, n, p] and `weight` [n, k] or [1 + m, n, k]; link i has the rows `bounds[i]` to
    `bounds[i + 1]`; `taken` [K] says which of moment x place x observable is a cell.
    """

    cells: list[Cell]
    taken: NDArray[np.intp]
    values: NDArray[np.float32]
    weight: NDArray[np.float32]
    bounds: NDArray[np.intp]

    @property
    def links(self) -> int:
        """How many links there are."""
        return len(self.bounds) - 1

    def sums(self, links: Links) -> NDArray[np.float32]:
        """Return the centred statistic of some links, [1 + m, l, K]."""
        mean = self._per_link(self.values, links)
        spread = self._per_link(np.abs(self.values), links)
        count = self._per_link(np.ones((*self.values.shape[:2], 1), np.float32), links)
        # Offsets of either sign, constant within a link, cancel in the mean but not here.
        offset = np.abs(mean) / np.sqrt(np.maximum(np.abs(count), np.float32(1)))
        moments = np.stack([mean, spread, offset], axis=2)
        whole = np.take(moments.reshape(*moments.shape[:2], -1), self.taken, axis=2)
        whole -= whole.mean(axis=0)
        return np.asarray(whole, np.float32)

    def _per_link(self, values: NDArray[np.float32], links: Links) -> NDArray[np.float32]:
        """Return sum of weight x `values` [1 + m, n, q] over rows of links, [1 + m, l, k, q]."""
        spans = zip(self.bounds[links], self.bounds[links + 1], strict=True)
        parts = [np.swapaxes(self.weight[..., a:b, :], -1, -2) @ values[:, a:b] for a, b in spans]
        return np.stack(parts, axis=1)


def _group(ensemble: Ensemble, found: list[tuple[Place, Floats]]) -> _Group:
    """Return places with their weights, rows sorted by link."""
    order = np.argsort(ensemble.links, kind="stable")
    bounds = np.flatnonzero(np.diff(ensemble.links[order], prepend=-1, append=-1))
    weight = np.stack([w for _, w in found], axis=-1).astype(np.float32)
    cells, taken = _cells(ensemble.names, [place for place, _ in found])
    values = standardised(ensemble)[:, order]
    return _Group(cells, taken, values, weight[..., order, :], bounds)


def _cells(names: tuple[str, ...], where: list[Place]) -> tuple[list[Cell], NDArray[np.intp]]:
    """Return the cells, and their positions in moment x place x observable."""
    cells, taken = [], []
    moments: tuple[Moment, ...] = ("mean", "spread", "link")
    for number, (moment, place) in enumerate(product(moments, where)):
        if place.trend and moment != "mean":
            continue
        kind: Moment = "slope" if place.trend else moment
        keep = [i for i, name in enumerate(names) if name != place.covariate]
        cells += [Cell(names[i], kind, place) for i in keep]
        taken += [number * len(names) + i for i in keep]
    return cells, np.array(taken, np.intp)
