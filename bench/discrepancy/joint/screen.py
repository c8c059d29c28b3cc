"""Trying every effect at many points of its parameters, on few rows.

What each point changes is remembered: the response of a set is about the sum of those of its
members, so what could be added to a set costs no simulation to find.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.search import revalued, valued
from bench.discrepancy.fit.starts import begun, delayed, elsewhere, free_parameters, onsets, starts
from bench.discrepancy.joint.likelihood import fitness, white, whitener
from bench.discrepancy.joint.polish import Fit, fitted, polished
from bench.discrepancy.joint.settings import (
    ALIKE,
    BEGUN,
    FAR_OFF,
    FITTED_ON,
    NAME_NATS,
    TAIL,
    TOUCHES,
    TRIED_BESIDE,
)
from bench.discrepancy.joint.statistics import Statistics
from bench.errors import BenchError
from bench.forked import in_forks
from bench.physics.effect import Effect

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tried:
    """An effect at one point, what it changes [L, p], and how likely it is, in nats.

    `gained`: how much likelier it is beside a set than the set without it.
    """

    effect: Effect
    response: Floats
    nats: float
    gained: float = 0.0


class Screen:
    """Points of every effect, tried beside effects that are in place (`start`).

    `points` maps names to what was tried, of effects that change anything.
    """

    def __init__(self, given: Statistics, kinds: Iterable[type[Effect]], start: Added = ()) -> None:
        self.given, self.start = given, start
        begin, mean = given.moments(start), given.mean(start)
        if begin is None or mean is None:
            raise BenchError("nothing can be simulated at these rows")
        self.begin, self._mean = begin, mean
        self._flat = whitener(given, begin, ())[0]
        self._nothing = fitness(given, begin, begin.left, (), 0)
        able = list(kinds)
        every = zip(able, in_forks(self._tried, able), strict=True)
        self.points: Mapping[str, Sequence[Tried]] = {k.name: made for k, made in every if made}

    def _tried(self, kind: type[Effect]) -> list[Tried]:
        points = starts(kind, False, True)
        made = self._points(kind, points)
        much = [one.nats < self._nothing if one else None for one in made]
        made += self._points(kind, onsets(kind, points, much) + begun(kind))
        found = [one for one in made if one]
        if not found:
            return []
        best = max(found, key=lambda one: one.nats).effect
        around = dict.fromkeys((best, _alone(best), *_varied(best)))
        more = [v for one in around for v in elsewhere(kind, one, False) + delayed(kind, one)]
        found += [one for one in self._points(kind, more) if one]
        return found + self._fitted_on(self.unlike(found, FITTED_ON))

    def _fitted_on(self, points: Iterable[Tried]) -> list[Tried]:
        """Return points fitted on from where they are: few parameters lie on the lines tried."""
        fits = (polished(self.given, (*self.start, one.effect)) for one in points)
        kept = [fit.effects[-1] for fit in fits if fit]
        made = ((one, self.given.mean((*self.start, one))) for one in kept)
        able = (self._point(one, mean) for one, mean in made)
        return [one for one in able if one]

    def unlike(self, points: Iterable[Tried], count: int) -> list[Tried]:
        """Return the likeliest points that do unlike things, likeliest first: `count` at most.

        A fit that begins where another did ends there.
        """
        out: list[Tried] = []
        ways: list[Floats] = []
        for one in sorted(points, key=lambda one: -one.nats):
            way = white(self._flat, one.response).ravel()
            way = way / max(float(np.linalg.norm(way)), 1e-9)
            if all(float(way @ other) < ALIKE for other in ways):
                out, ways = [*out, one], [*ways, way]
            if len(out) == count:
                break
        return out

    def _points(self, kind: type[Effect], many: Iterable[dict[str, float]]) -> list[Tried | None]:
        """Return points, None where one cannot be simulated or changes nothing."""
        effects = [_effect(kind, values) for values in many]
        means = iter(self.given.means([(*self.start, one) for one in effects if one]))
        return [self._point(one, next(means)) if one else None for one in effects]

    def _point(self, effect: Effect, mean: Floats | None) -> Tried | None:
        """Return one point of which one version has this mean."""
        kind = type(effect)
        if mean is None:
            return None
        if kind.by_rows:
            return self._scattered(effect)
        response = mean - self._mean
        if (white(self._flat, response) ** 2).sum() < TOUCHES:
            return None
        count = len(free_parameters(kind))
        left = self.begin.left - response
        return Tried(effect, response, fitness(self.given, self.begin, left, (response,), count))

    def _scattered(self, effect: Effect) -> Tried | None:
        """Return one point of an effect that draws rows anew, by what it does to scatter."""
        made = self.given.moments((*self.start, effect))
        if made is None:
            return None
        response = made.mean - self.begin.mean
        count = len(free_parameters(type(effect)))
        return Tried(effect, response, fitness(self.given, made, made.left, (response,), count))

    def singly(self) -> list[Tried]:
        """Return the likeliest point of every effect, likeliest first."""
        best = [max(points, key=lambda one: one.nats) for points in self.points.values()]
        return sorted(best, key=lambda one: -one.nats)

    def begun(self, count: int) -> list[Effect]:
        """Return where fits of the `count` likeliest effects begin, at unlike points of each."""
        names = [one.effect.name for one in self.singly()[:count]]
        return [one.effect for n in names for one in self.unlike(self.points[n], BEGUN)]

    def beside(self, effects: Added) -> list[Tried]:
        """Return the likeliest point of every other effect beside a set, likeliest first."""
        now = fitted(self.given, effects)
        if now is None:
            return []
        have = set(now.names)
        able = {name: points for name, points in self.points.items() if name not in have}
        best = [self._best_beside(now, points) for points in able.values()]
        if self._unexplained(now) and max((b.gained for b in best), default=0.0) < NAME_NATS:
            usual = [points[0] for points in able.values()]  # no fit made that stand for others
            tried = zip(*(self._simulated_beside(now, some) for some in (best, usual)), strict=True)
            best = [max(each, key=lambda one: one.nats) for each in tried]
        return sorted(best, key=lambda one: -one.nats)

    def _unexplained(self, now: Fit) -> bool:
        """Return whether links are farther from a set than its simulated ones scatter."""
        matrices, _ = whitener(self.given, now.moments, now.responses)
        return float((white(matrices, now.moments.left) ** 2).mean()) > FAR_OFF

    def _simulated_beside(self, now: Fit, best: Sequence[Tried]) -> list[Tried]:
        """Return points with what they do beside a set: what was loud alone may be little there.

        Decibels do not add up: what stands in the way takes more off a profile without a tail.
        """
        mean = self.given.mean(now.effects)
        means = self.given.means([(*now.effects, one.effect) for one in best])
        return [
            one if other is None or mean is None or type(one.effect).by_rows
            else self._added(now, replace(one, response=other - mean))
            for one, other in zip(best, means, strict=True)
        ]  # fmt: skip

    def _best_beside(self, now: Fit, points: Sequence[Tried]) -> Tried:
        """Return the likeliest of some points beside a set: of those that leave least."""
        if type(points[0].effect).by_rows:
            return self._scattered_beside(now, points)
        matrices, _ = whitener(self.given, now.moments, now.responses)
        flat = white(matrices, now.moments.left)
        weights = 1 / (TAIL + (flat**2).sum(axis=1))[:, None]
        moved = (white(matrices, one.response) for one in points)
        falls = [float((weights * (2 * flat - each) * each).sum()) for each in moved]
        some = np.argsort(falls)[-TRIED_BESIDE:]
        return max((self._added(now, points[i]) for i in some), key=lambda one: one.nats)

    def _scattered_beside(self, now: Fit, points: Sequence[Tried]) -> Tried:
        """Return the likeliest point of an effect that draws rows anew beside a set."""
        best = sorted(points, key=lambda one: -one.nats)[:TRIED_BESIDE]
        made = ((one, fitted(self.given, (*now.effects, one.effect))) for one in best)
        nats = [(one, fit.nats if fit else -np.inf) for one, fit in made]
        one, most = max(nats, key=lambda each: each[1])
        return Tried(one.effect, one.response, most, most - now.nats)

    def _added(self, now: Fit, one: Tried) -> Tried:
        """Return a point with how likely it is about beside a set."""
        responses = (*now.responses, one.response)
        count = now.parameters + len(free_parameters(type(one.effect)))
        left = now.moments.left - one.response
        nats = fitness(self.given, now.moments, left, responses, count)
        return Tried(one.effect, one.response, nats, nats - now.nats)


def _effect(kind: type[Effect], values: dict[str, float]) -> Effect | None:
    """Return the effect with these values, None where it has none such."""
    try:
        return valued(kind, values)
    except BenchError:
        return None


def _alone(effect: Effect) -> Effect:
    """Return an effect with none but its first amplitude: another may swamp what it does."""
    amplitudes = [p for p in free_parameters(type(effect)) if p.null is not None]
    off = {p.name: float(p.null or 0.0) for p in amplitudes[1:]}
    values = {p.name: float(getattr(effect, p.name)) for p in free_parameters(type(effect))}
    return valued(type(effect), values | off)


def _varied(effect: Effect) -> list[Effect]:
    """Return an effect with the values from where else a search begins, its level as it is."""
    return [revalued(effect, dict(one)) for one in type(effect).begins[:2]]
