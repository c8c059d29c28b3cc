"""What a simulated table's observables are behind one kind of obstacles, and behind another.

Where few links stand behind three walls, those that are near in all else stand behind one or two.
What that makes of an observable is taken out as what a distance makes is (see `over_distance`):
on the simulated side, so that what only recordings have stays. Metal does much the same in every
room: first what obstacles do is told over all rooms, then what links of one room do beside it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.discrepancy.compare.over_distance import Walk, of_links
from bench.discrepancy.compare.settings import KIND_FREEDOM, LEAST_VARIANCE, WALK_CLIP
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats


@dataclass(frozen=True)
class OfKinds:
    """What kinds [c] do to one observable, and how far rows' links [k] are `off` their kind.

    `step` [c]: how far a kind is off all others, NaN where that is unknown, of which the part
    `told` [c] is not taken for chance. `scatter` [c]: the standard deviation of links of a kind, in
    those of all. `freedom`: how many times as far links are off a mean that they had no part in.
    """

    step: Floats
    told: Floats
    scatter: Floats
    off: Floats
    freedom: float = 1.0


@dataclass(frozen=True)
class Layer:
    """Kinds of recorded rows `ours` [n] and simulated ones `theirs` [k]; what they do [p]."""

    ours: Rows
    theirs: Rows
    kinds: tuple[OfKinds, ...]

    def apart(self, which: int, pick: Rows) -> Floats:
        """Return how far kinds of ours are from those of simulated rows `pick` [n], or NaN."""
        step = self.kinds[which].step
        return np.asarray(step[self.ours] - step[self.theirs[pick]])


@dataclass(frozen=True)
class OverKinds:
    """What kinds do to `names` [p], in layers from all rooms to one.

    A link behind metal is off by more than one in sight: a simulated link that stands for one of
    another kind is as far off its kind as links of ours are.
    """

    names: tuple[str, ...]
    layers: tuple[Layer, ...]

    def change(self, names: tuple[str, ...], pick: Rows) -> Floats:
        """Return by how much observables [n, q] change from simulated rows `pick` [n] to ours."""
        made = np.zeros((len(pick), len(names)))
        for at, name in enumerate(names):
            if name in self.names:
                made[:, at] = self._change(self.names.index(name), pick)
        return made

    def steps(self, which: int) -> Floats:
        """Return how far the kind of every simulated row is off all others [k], in one observable.

        Of all layers together; nothing where that is unknown.
        """
        every = (np.nan_to_num(one.kinds[which].step[one.theirs]) for one in self.layers)
        return np.asarray(np.sum(list(every), axis=0), np.float64)

    def _change(self, which: int, pick: Rows) -> Floats:
        """Return by how much one observable [n] changes, its scatter about its kind with it."""
        made = np.zeros(len(pick))
        for one in self.layers:
            made += np.nan_to_num(one.apart(which, pick))
        last = self.layers[-1]
        of, theirs = last.kinds[which], last.theirs[pick]
        known = np.isfinite(last.apart(which, pick)) & (last.ours != theirs)
        wider = of.freedom * of.scatter[last.ours] / of.scatter[theirs] - 1
        return np.asarray(made + np.where(known, wider * of.off[pick], 0.0))


def over_kinds(
    observed: Observables, over: Mapping[str, Walk], range_m: Floats, links: Rows,
    codes: Sequence[tuple[Rows, Rows]],
) -> OverKinds:  # fmt: skip
    """Return what kinds of simulated rows do [k], to recorded rows [n]: `codes` of both, by layer.

    Means over `links` [k] beside the walk `over` the distance, each nearer to zero the less it is
    told from it (a random effect: Robinson 1991).
    """
    every = [_in_layers(one, links, codes) for one in beside_walk(observed, over, range_m).T]
    made = zip(codes, zip(*every, strict=True), strict=True)
    layers = [Layer(ours, theirs, kinds) for (ours, theirs), kinds in made]
    return OverKinds(observed.names, tuple(layers))


def beside_walk(observed: Observables, over: Mapping[str, Walk], range_m: Floats) -> Floats:
    """Return what is left of observables [k, p] beside their walk over the distance."""
    decades = np.log10(np.where(range_m > 0, range_m, 1.0))
    walked = [over.get(name, Walk(0.0)).at(decades) for name in observed.names]
    return np.asarray(observed.values - np.stack(walked, axis=1))


def _in_layers(values: Floats, links: Rows, codes: Sequence[tuple[Rows, Rows]]) -> list[OfKinds]:
    """Return what kinds do to one observable, each layer beside those before it."""
    out: list[OfKinds] = []
    usual = np.ones(len(values))
    for ours, theirs in codes:
        many = 1 + int(max(ours.max(initial=0), theirs.max(initial=0)))
        out.append(_of_kinds(values, links, theirs, many, usual))
        values = values - np.nan_to_num(out[-1].step[theirs])
        usual = out[-1].scatter[theirs] ** 2
    return out


def _of_kinds(values: Floats, links: Rows, kinds: Rows, many: int, usual: Floats) -> OfKinds:
    """Return what `many` kinds do to one observable; nothing of too few links.

    `usual` [k]: the variance that links of rows have in the layer before, in that of all.
    """
    known = np.isfinite(values)
    code, each = of_links(links[known], kinds[known])
    kind, at = np.unique(each, return_inverse=True)
    step, told, scatter = np.full(many, np.nan), np.zeros(many), np.ones(many)
    off = np.zeros(len(values))
    if len(kind) < 2 or len(at) <= len(kind):
        return OfKinds(step, told, scatter, off)
    high = _usual(_means(values[known], code), at)
    square, noise, between = _parts(high, at)
    count = np.bincount(at)
    told[kind] = between / np.maximum(between + noise / count, LEAST_VARIANCE)
    step[kind] = told[kind] * (_means(high, at) - high.mean())
    prior = KIND_FREEDOM * _means(_means(usual[known], code), at)
    share = square / max(noise, LEAST_VARIANCE)
    scatter[kind] = np.sqrt((share + prior) / (count - 1 + KIND_FREEDOM))
    off[known] = (high - high.mean() - step[each])[code]
    freedom = float(np.sqrt(len(at) / (len(at) - (told * (2 - told)).sum())))
    return OfKinds(step, told, scatter, off, freedom)


def _usual(high: Floats, at: Rows) -> Floats:
    """Return means of links [L] of kinds `at` [L], at most as far from their kind as is usual."""
    middle = np.array([np.median(high[at == k]) for k in range(int(at.max()) + 1)])[at]
    most = WALK_CLIP * float(np.median(np.abs(high - middle)))
    return np.asarray(middle + np.clip(high - middle, -most, most))


def _parts(high: Floats, at: Rows) -> tuple[Floats, float, float]:
    """Return squares within every kind [c], the variance of links of one, and that of kinds."""
    mean, count = _means(high, at), np.bincount(at)
    square = np.asarray(np.bincount(at, (high - mean[at]) ** 2), np.float64)
    noise = float(square.sum()) / (len(at) - len(count))
    apart = (mean - high.mean()) ** 2 - noise / count
    return square, noise, max(float(np.average(apart, weights=count)), 0.0)


def _means(high: Floats, at: Rows) -> Floats:
    return np.asarray(np.bincount(at, high) / np.bincount(at))
