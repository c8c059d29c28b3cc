"""Fitting the parameters of all effects of a set at once, by Gauss and Newton.

Differences are taken on common random numbers, so they are smooth. Means are fitted as they weigh
in the likelihood; squared deviations beside them, of links and of rows about their link's mean, by
which scatter is fitted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.search import revalued
from bench.discrepancy.fit.starts import between, by_ratio, free_parameters, inside
from bench.discrepancy.joint.likelihood import fitness, white, whitener
from bench.discrepancy.joint.other_ways import as_high, other_log
from bench.discrepancy.joint.row_likelihood import come_and_gone
from bench.discrepancy.joint.settings import (
    DAMPING,
    DONE_NATS,
    FIT_ROUNDS,
    LONGEST_STEP,
    NAME_NATS,
    SPREAD_WEIGHT,
    STARTED,
    STEP,
    STEPS,
    TAIL,
    UNEVEN,
    UNSURE_NATS,
)
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Fit:
    """A set of effects as fitted: what its members do beside the others, and how likely it is.

    `responses`: the change of the simulated mean [L, p] by each; `nats` as `fitness` gives; `off`:
    how many parameters do nothing because they need not.
    """

    effects: Added
    moments: Moments
    responses: tuple[Floats, ...]
    nats: float
    off: int = 0

    @property
    def key(self) -> tuple[Added, int]:
        """What tells it from others that are fitted to the same statistics."""
        return self.effects, self.off

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the effects."""
        return tuple(effect.name for effect in self.effects)

    @property
    def parameters(self) -> int:
        """How many parameters were fitted, but for those that are off."""
        return sum(len(free_parameters(type(effect))) for effect in self.effects) - self.off


def key_of(effects: Added) -> frozenset[str]:
    """Return what a set of effects is known by: their names."""
    return frozenset(effect.name for effect in effects)


def fitted(given: Statistics, effects: Added) -> Fit | None:
    """Return a set of effects as they are, None where they cannot be simulated."""
    moments = given.moments(effects)
    rests = [given.moments(effects[:i] + effects[i + 1 :]) for i in range(len(effects))]
    if moments is None or any(rest is None for rest in rests):
        return None
    responses = tuple(moments.mean - rest.mean for rest in rests if rest is not None)
    count = sum(len(free_parameters(type(effect))) for effect in effects)
    able = zip(effects, responses, strict=True)
    varied = [(r, groups) for effect, r in able if (groups := _groups(given, effect)) is not None]
    moments = replace(moments, own=_own(varied))
    links = _uneven([response for response, _ in varied])
    rows = _uneven([r for e, r in zip(effects, responses, strict=True) if type(e).by_device])
    rows = rows if given.told_within else rows[:1]
    each = [come_and_gone(given, moments, one, other) for one in links for other in rows]
    made = (Fit(effects, m, responses, fitness(given, m, m.left, responses, count)) for m in each)
    return max(made, key=lambda fit: fit.nats)


def _groups(given: Statistics, effect: Effect) -> Floats | None:
    """Return the groups of links [L, r] that each have a size of their own of an effect, or None.

    Those of devices, or of kinds of obstacles.
    """
    kind = type(effect)
    return given.devices if kind.by_device else given.kinds if kind.by_kind else None


def _uneven(varied: Sequence[Floats]) -> list[Floats | None]:
    """Return by how much links may differ in responses of which groups do [L, p, k], or not."""
    return [None, *(size * np.stack(varied, axis=2) for size in UNEVEN if varied)]


def _own(varied: Sequence[tuple[Floats, Floats]]) -> Floats | None:
    """Return what groups [L, r] may have of their own of responses [L, p] of which they do.

    Of a size that is not negative only the mean is known, the response: the likeliest law of that
    (of most entropy) is exponential, whose standard deviation is its mean. So factors are of one.
    """
    parts = [response[:, :, None] * groups[:, None] for response, groups in varied]
    return np.concatenate(parts, axis=2) if parts else None


def polished(given: Statistics, effects: Added, steps: int = STEPS) -> Fit | None:
    """Return a set of effects fitted from where they are, None where they cannot be simulated.

    With what effects seldom do, and without it where that is likelier.
    """
    begun = fitted(given, effects)
    if begun is None or not len(shares(effects)):
        return begun
    best = _other_way(given, in_rounds(given, begun, steps, ()), steps)
    held = [place for place, rare in enumerate(_seldom(effects)) if rare]
    if not shares(best.effects)[held].any():
        return best
    at = shares(effects)
    at[held] = 0
    plain = fitted(given, with_shares(effects, at))
    others = [in_rounds(given, plain, steps, held)] if plain else []
    return max([best, *others], key=lambda fit: fit.nats)


def likeliest(given: Statistics, tries: Sequence[Added]) -> Fit | None:
    """Return the likeliest of some sets, fitted; of many those that are likeliest as they are."""
    able = list(tries)
    if len(able) > STARTED:
        known = [fit for fit in (fitted(given, one) for one in able) if fit]
        known.sort(key=lambda fit: -fit.nats)
        able = [fit.effects for fit in known[:STARTED]]
    made = [fit for fit in (polished(given, one) for one in able) if fit]
    return max(made, key=lambda fit: fit.nats, default=None)


def _other_way(given: Statistics, fit: Fit, steps: int) -> Fit:
    """Return a set whose effects do in the other way what they may where that is likelier.

    What another tool's noise is of, nobody told: of its power a tone raises as much as noise does.
    Nor whether a wider pulse is as high as before.
    """
    ways = [as_high] if given.by_rows else [other_log, as_high]
    for way in ways:
        changed = tuple(map(way, fit.effects))
        other = fitted(given, changed) if changed != fit.effects else None
        if other is not None and other.nats > fit.nats:
            fit = in_rounds(given, other, steps, ())
    return fit


def _seldom(effects: Added) -> list[bool]:
    """Return of every free parameter whether it is of what its effect seldom does."""
    return [p.name == type(e).seldom for e in effects for p in free_parameters(type(e))]


def in_rounds(given: Statistics, best: Fit, steps: int, held: Sequence[int]) -> Fit:
    """Return a fit on from `best`; one whose last step gained a name goes on with new slopes.

    The parameters in the places `held` stay as they are.
    """
    for _ in range(FIT_ROUNDS):
        best, gained = _stepped(given, best, steps, held)
        if gained < NAME_NATS:
            break
    return best


def _stepped(given: Statistics, best: Fit, steps: int, held: Sequence[int]) -> tuple[Fit, float]:
    """Return a fit some steps on, and what the last of them gained in nats."""
    slopes, gained = Slopes.at(given, best).without(held), 0.0
    for _ in range(steps):
        better = _step(given, best, slopes)
        if better is None:
            return best, 0.0
        gained, before, best = better.nats - best.nats, best, better
        if gained < DONE_NATS:
            break
        slopes = slopes.corrected(before, best)
    return best, gained


@dataclass(frozen=True)
class Slopes:
    """How a fit changes with every share: what is fitted [L, 3 p, k], and the likelihood.

    `beyond` [k]: how the log likelihood rises beyond what the squares of what is fitted say of it:
    they know nothing of how scatter widens its volume, nor how it is correlated.
    """

    ways: Floats
    beyond: Floats

    @classmethod
    def at(cls, given: Statistics, now: Fit) -> Slopes:
        """Return the slopes where a fit is."""
        ways = slopes_of(given, now)
        here, each = at_work(given, now, ways)
        squares = -each.reshape(len(each), -1) @ here.ravel()
        return cls(ways, _rises(given, now) - squares)

    def without(self, held: Sequence[int]) -> Slopes:
        """Return slopes by which the parameters in the places `held` stay as they are."""
        ways, beyond = self.ways.copy(), self.beyond.copy()
        ways[..., list(held)] = 0
        beyond[list(held)] = 0
        return Slopes(ways, beyond)

    def corrected(self, before: Fit, after: Fit) -> Slopes:
        """Return slopes that agree with a step (Broyden 1965): cheaper than new differences."""
        way = shares(after.effects) - shares(before.effects)
        came = _statistics(after.moments) - _statistics(before.moments)
        more = (came - self.ways @ way)[..., None] * way / max(float(way @ way), 1e-12)
        return replace(self, ways=self.ways + more)


def _rises(given: Statistics, now: Fit) -> Floats:
    """Return how the log likelihood rises with every share [k], as links count without sharing."""
    out = np.zeros(len(shares(now.effects)))
    for place in range(len(out)):
        way, moved = _moved(given, now, place, STEP)
        if moved is not None:
            moved = come_and_gone(given, moved, now.moments.uneven, now.moments.uneven_rows)
            nats = fitness(given, moved, moved.left, now.responses, now.parameters)
            out[place] = given.crowding * (nats - now.nats) / way
    return out


def _moved(given: Statistics, now: Fit, place: int, step: float) -> tuple[float, Moments | None]:
    """Return how far one share is moved, `step` of the bounds up or down, and the moments there."""
    at = shares(now.effects)
    way = step if 0 <= at[place] + step <= 1 else -step
    return way, given.moments(with_shares(now.effects, at + way * (np.arange(len(at)) == place)))


def _statistics(moments: Moments) -> Floats:
    """Return all that is fitted [L, 3 p]: means, then squared deviations, then those of rows."""
    return np.hstack([moments.left, moments.spread_left, moments.rows_left])


def slopes_of(given: Statistics, now: Fit, step: float = STEP) -> Floats:
    """Return how what is fitted changes with every share [L, 3 p, k], `step` of the bounds on."""
    here, count = _statistics(now.moments), len(shares(now.effects))
    slopes = np.zeros((*here.shape, count))
    for place in range(count):
        way, moved = _moved(given, now, place, step)
        if moved is not None:
            slopes[..., place] = (_statistics(moved) - here) / way
    return slopes


def _step(given: Statistics, now: Fit, slopes: Slopes) -> Fit | None:
    """Return a likelier set one step on, None where none is found."""
    here, each = at_work(given, now, slopes.ways)
    ways = each.reshape(len(each), -1)
    inner, squares = ways @ ways.T, ways @ here.ravel()
    at = shares(now.effects)
    # By squares alone, whose slopes reach farthest, then by all that the likelihood is of.
    beyonds = (np.zeros(len(at)), slopes.beyond, slopes.beyond)
    best = None
    for damping, beyond in zip(DAMPING, beyonds, strict=True):
        right = squares - beyond
        ridge = damping * np.diag(inner) + 1e-3 * np.trace(inner) / len(at) + 1e-9
        way = -np.linalg.solve(inner + np.diag(ridge), right)
        there = np.clip(at + np.clip(way, -LONGEST_STEP, LONGEST_STEP), 0, 1)
        better = _if_likelier(given, with_shares(now.effects, there), best or now)
        best = better or best
        if best is not None and best.nats - now.nats >= DONE_NATS:
            break
    return best


def _if_likelier(given: Statistics, effects: Added, now: Fit) -> Fit | None:
    """Return effects at other parameters, None where they are no likelier than `now`."""
    moments = given.moments(effects)
    if moments is None:
        return None
    moments = come_and_gone(given, moments, now.moments.uneven, now.moments.uneven_rows)
    nats = fitness(given, moments, moments.left, now.responses, now.parameters)
    if nats <= now.nats - UNSURE_NATS:  # as far as can be said before responses are simulated
        return None
    better = fitted(given, effects)
    return better if better and better.nats > now.nats else None


def at_work(given: Statistics, now: Fit, slopes: Floats) -> tuple[Floats, Floats]:
    """Return what is fitted [L, 3 p] and its slopes [k, L, 3 p], as they weigh in the fit."""
    matrices, _ = whitener(given, now.moments, now.responses)
    square = (white(matrices, now.moments.left) ** 2).sum(axis=1)
    weights = np.sqrt((TAIL + matrices.shape[1]) / (TAIL + square))[:, None]
    often = np.sqrt(np.maximum(given.count - 1, 0))[:, None]

    def weighed(values: Floats) -> Floats:
        means, spreads, rows = np.hsplit(values, 3)
        wide = SPREAD_WEIGHT * spreads, SPREAD_WEIGHT * often * rows
        return np.hstack([weights * white(matrices, means), *wide])

    here = weighed(_statistics(now.moments))
    return here, np.stack([weighed(one) for one in np.moveaxis(slopes, 2, 0)])


def shares(effects: Added) -> Floats:
    """Return where every free parameter lies between its bounds, 0 to 1; by ratio over decades."""
    return np.array(
        [_share(p, float(getattr(e, p.name))) for e in effects for p in free_parameters(type(e))]
    )


def _share(item: Parameter, value: float) -> float:
    if by_ratio(item):
        return float(np.log(value / item.low) / np.log(item.high / item.low))
    return (value - item.low) / (item.high - item.low)


def with_shares(effects: Added, at: Floats) -> Added:
    """Return the effects with parameters where `at` says (see `shares`)."""
    out: list[Effect] = []
    start = 0
    for effect in effects:
        free = free_parameters(type(effect))
        values = dict(zip(free, at[start : start + len(free)].tolist(), strict=True))
        out.append(revalued(effect, _values(values)))
        start += len(free)
    return tuple(out)


def _values(values: Mapping[Parameter, float]) -> dict[str, float]:
    return {
        p.name: inside(p, between(p, p.low, p.high, float(np.clip(share, 0, 1))))
        for p, share in values.items()
    }
