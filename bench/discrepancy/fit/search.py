"""Fitting one effect within its physical bounds, on common random numbers so it is smooth."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from bench.discrepancy.compare.ensemble import NothingSharedError
from bench.discrepancy.compare.skill import Tally, gain, tally
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.fit.starts import (
    by_level,
    by_ratio,
    delayed,
    elsewhere,
    free_parameters,
    inside,
    starts,
    switched_off,
)
from bench.discrepancy.settings import (
    BACKFIT_EVALUATIONS,
    EVALUATIONS,
    EVALUATIONS_PER_PARAMETER,
    FIRST_STEP_AT_NULL,
    FIRST_STEP_DB,
    FIRST_STEP_LOG,
    FIRST_STEP_OF_WAY,
    FIRST_STEP_OTHER,
    FIT_MEMBERS,
    IDLE_NATS,
    MORE_DESCENTS,
    NOTHING_NATS,
    SIMPLEX_DONE,
    STALLED,
    STRIKING_RICHER,
)
from bench.errors import BenchError
from bench.forked import in_forks
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Fitted:
    """An effect with the parameters that scored best, its gain on the rows it was fitted on."""

    effect: Effect
    gain: float
    evaluations: int


class Objective:
    """Gain of one kind of effect over the current simulator as a function of its parameters.

    `held` are the values of parameters that no search fits (see `Effect.instead`).
    """

    def __init__(
        self, kind: type[Effect], comparison: Comparison, view: View, added: Added, base: Tally
    ) -> None:
        self.kind, self.comparison, self.view, self.added, self.base = (
            kind,
            comparison,
            view,
            added,
            base,
        )
        self.free = free_parameters(kind)
        self.held: dict[str, float] = {}
        self.evaluations = 0
        self.best: tuple[float, Effect] | None = None

    def __call__(self, values: dict[str, float]) -> float:
        """Return the gain of these parameter values; what is not finite counts as nothing.

        Raises BenchError where the effect itself fails.
        """
        return self._noted(self._tried(values))

    def each(self, several: Iterable[dict[str, float]]) -> None:
        """Try parameter values beside one another, where forks may.

        Raises BenchError where the effect itself fails.
        """
        for tried in in_forks(self._tried, several):
            self._noted(tried)

    def _noted(self, tried: tuple[float, Effect]) -> float:
        """Return the gain of an effect that was tried, which may be the best so far."""
        self.evaluations += 1
        found, effect = tried
        if found > NOTHING_NATS and (self.best is None or found > self.best[0]):
            self.best = (found, effect)
        return found

    def _tried(self, values: dict[str, float]) -> tuple[float, Effect]:
        """Return the gain of parameter values, and the effect."""
        effect = valued(self.kind, {**self.held, **values})
        members = members_for(self.kind, self.view, FIT_MEMBERS)
        try:
            made = self.comparison.ensemble(self.view, (*self.added, effect), members)
        except NothingSharedError as problem:
            raise BenchError(
                f"effect {self.kind.name!r} gives values that are not finite"
            ) from problem
        except BenchError:
            raise
        except Exception as problem:
            raise BenchError(f"effect {self.kind.name!r} failed: {problem}") from problem
        found = gain(self.base, tally(made))
        if set(made.names) < set(self.base.names) or not np.isfinite(found):
            found = NOTHING_NATS
        return found, effect


def members_for(kind: type[Effect], view: View, members: int) -> int:
    """Return how many members an effect is judged by: more where it strikes links at random.

    Few draws per link are few strikes, and parameters would be fitted to the draws.
    """
    return STRIKING_RICHER * members if kind.per_link and not view.waveform else members


def screen(objective: Objective, on_ranges: bool = False) -> Fitted:
    """Return the best of a line search along every amplitude of the effect.

    An amplitude is a parameter with a value at which the effect does nothing; the others stay at
    their defaults. Effects without one are tried at points spread over their bounds. `on_ranges`:
    it is known by what it does to ranges, so it is tried with all else that it does switched off.
    """
    thorough = not objective.view.waveform  # paths alone cost next to nothing
    several = len(objective.view.recorded.names) > 1
    objective.each(starts(objective.kind, thorough, several))
    if objective.best is None:
        raise BenchError(f"effect {objective.kind.name!r} gives values that are not finite")
    objective.each(elsewhere(objective.kind, objective.best[1], thorough))
    objective.each(delayed(objective.kind, objective.best[1]))
    if several and (thorough or on_ranges):
        objective.each(switched_off(objective.kind))
    return Fitted(objective.best[1], objective.best[0], objective.evaluations)


def valued(kind: type[Effect], values: dict[str, float]) -> Effect:
    """Return the effect with these values, whole-number parameters rounded."""
    whole = {item.name for item in fields(kind) if item.type in ("int", int)}
    return kind.from_values({k: round(v) if k in whole else v for k, v in values.items()})


def revalued(effect: Effect, values: dict[str, float]) -> Effect:
    """Return the effect with these values, and its own of all else, as what is not fitted."""
    return valued(type(effect), {**vars(effect), **values})


def refine(objective: Objective, start: Fitted, evaluations: int | None = None) -> Fitted:
    """Return the local optimum near `start` (see `pursue` for what many parameters need)."""
    if not objective.free:
        return start
    evaluations = evaluations or EVALUATIONS
    if objective.view.waveform:
        evaluations = max(evaluations, EVALUATIONS_PER_PARAMETER * len(objective.free))
    return _descended(objective, start, evaluations)


def plainer(objective: Objective, found: Fitted, price: float) -> Fitted:
    """Return the fit without what is off by default and gains less than a price in nats.

    A warm-up that follows the scatter leaves no slope over the temperature determined. What the
    rest gains as it stands is asked first, as another search costs much; that comes once, at last.
    """
    rough = False
    for item in (p for p in objective.free if p.null is not None and p.default == p.null):
        rest = tuple(p for p in objective.free if p is not item)
        if getattr(found.effect, item.name) == item.null or all(p.null is None for p in rest):
            continue
        other = _without(objective, rest)
        made = _at(other, found.effect)
        enough = made.gain > found.gain - price
        made = made if enough else _nearby(other, made)
        if made.gain > found.gain - price:
            objective, found, rough = other, made, enough
    return refine(objective, found) if rough else found


def _nearby(objective: Objective, start: Fitted) -> Fitted:
    """Return the local optimum near a start that was one with a parameter more.

    With waveforms every look costs a simulation, and the way from there is short.
    """
    if objective.view.waveform:
        return _descended(objective, start, BACKFIT_EVALUATIONS)
    return refine(objective, start)


def _without(objective: Objective, rest: tuple[Parameter, ...]) -> Objective:
    """Return the objective with the parameters `rest` alone free, the others as by default."""
    made = Objective(
        objective.kind, objective.comparison, objective.view, objective.added, objective.base
    )
    made.free = rest
    return made


def _at(objective: Objective, effect: Effect) -> Fitted:
    """Return what an effect's values of the free parameters gain."""
    start = valued(objective.kind, {p.name: float(getattr(effect, p.name)) for p in objective.free})
    return Fitted(start, objective(vars(start)), 1)


def pursue(objective: Objective, found: Fitted) -> Fitted:
    """Return the optimum after further searches, each from where the last one ended.

    A simplex in many dimensions shrinks before it has arrived; a fresh one goes on.
    """
    for _ in range(MORE_DESCENTS):
        before, found = found.gain, refine(objective, found)
        if found.gain - before < STALLED * max(abs(found.gain), 1.0):
            break
    return found


def _descended(objective: Objective, start: Fitted, evaluations: int) -> Fitted:
    """Return the end of one bounded Nelder-Mead search on scaled parameters."""
    free = objective.free
    low, high = (np.array([_scaled(p, end) for p, end in _ends(free, w)]) for w in (0, 1))
    now = np.array([_scaled(p, getattr(start.effect, p.name)) for p in free])
    scale = np.array([_step(p, getattr(start.effect, p.name)) for p in free])

    def loss(x: Floats) -> float:
        values = np.clip(now + x * scale, low, high)
        return -objective({p.name: _plain(p, v) for p, v in zip(free, values, strict=True)})

    ways = np.eye(len(free))
    if not objective.view.waveform:
        ways = ways[_moving(loss, ways)]  # a simplex of idle dimensions only shrinks
    simplex = np.vstack([np.zeros(len(ways)), np.eye(len(ways))])
    options: Any = {
        "maxfev": evaluations,
        "initial_simplex": simplex,
        "xatol": SIMPLEX_DONE[0],
        "fatol": SIMPLEX_DONE[1],
    }

    def along(y: Floats) -> float:
        return loss(y @ ways)

    if len(ways):
        minimize(along, simplex[0], method="Nelder-Mead", options=options)
    if objective.best is None:
        return start
    return Fitted(objective.best[1], objective.best[0], objective.evaluations)


def _moving(loss: Callable[[Floats], float], ways: Floats) -> NDArray[np.intp]:
    """Return which of some steps change the loss at all: paths alone leave parameters idle."""
    here = loss(np.zeros(ways.shape[1]))
    return np.flatnonzero([abs(loss(way) - here) > IDLE_NATS for way in ways])


def _ends(free: tuple[Parameter, ...], which: int) -> list[tuple[Parameter, float]]:
    """Return each parameter with its lower (0) or upper (1) bound."""
    return [(p, (p.low, p.high)[which]) for p in free]


def _scaled(item: Parameter, value: float) -> float:
    """Return the value as the search sees it: its logarithm where it spans decades."""
    return float(np.log(value)) if by_ratio(item) else float(value)


def _plain(item: Parameter, scaled: float) -> float:
    """Return the value in the parameter's unit, within its bounds."""
    return inside(item, float(np.exp(scaled)) if by_ratio(item) else float(scaled))


def _step(item: Parameter, value: float) -> float:
    """Return a first step: a third of the way from null, or a tenth of the bounds.

    A factor of 1.6 for a parameter that spans decades, 3 dB for a level.
    """
    if by_level(item):
        return FIRST_STEP_DB if value + FIRST_STEP_DB <= item.high else -FIRST_STEP_DB
    if by_ratio(item):
        return FIRST_STEP_LOG if value < item.high / 2 else -FIRST_STEP_LOG
    low, high, value = (_scaled(item, v) for v in (item.low, item.high, value))
    null = None if item.null is None else _scaled(item, item.null)
    if null is not None and value != null:
        step = (value - null) / FIRST_STEP_OF_WAY
    else:
        step = (high - low) * (FIRST_STEP_AT_NULL if null is not None else FIRST_STEP_OTHER)
    return float(step if value + step <= high else -step)
