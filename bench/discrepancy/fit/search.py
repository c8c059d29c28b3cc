"""Fitting one effect within its physical bounds, on common random numbers so it is smooth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import qmc

from bench.discrepancy.compare.ensemble import NothingSharedError
from bench.discrepancy.compare.skill import Tally, gain, tally
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.settings import (
    DECADES,
    DECIBEL_STEPS,
    DELAY_POINTS,
    ELSEWHERE_LEVELS,
    ELSEWHERE_POINTS,
    ELSEWHERE_SHARES,
    EVALUATIONS,
    EVALUATIONS_PER_PARAMETER,
    FINE_LINE_STEPS,
    FIRST_STEP_AT_NULL,
    FIRST_STEP_DB,
    FIRST_STEP_LOG,
    FIRST_STEP_OF_WAY,
    FIRST_STEP_OTHER,
    FIT_MEMBERS,
    IDLE_NATS,
    LINE_STEPS,
    LOUD_DB,
    MORE_DESCENTS,
    NOTHING_NATS,
    RATIO_STEPS,
    SCATTERED_POINTS,
    SIMPLEX_DONE,
    STALLED,
    STRIKING_RICHER,
)
from bench.errors import BenchError
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Fitted:
    """An effect with the parameters that scored best, its gain on the rows it was fitted on."""

    effect: Effect
    gain: float
    evaluations: int


class Objective:
    """Gain of one kind of effect over the current simulator as a function of its parameters."""

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
        self.evaluations = 0
        self.best: tuple[float, Effect] | None = None

    def __call__(self, values: dict[str, float]) -> float:
        """Return the gain of these parameter values; what is not finite counts as nothing.

        Raises BenchError where the effect itself fails.
        """
        self.evaluations += 1
        effect = valued(self.kind, values)
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
            return NOTHING_NATS
        if self.best is None or found > self.best[0]:
            self.best = (found, effect)
        return found


def members_for(kind: type[Effect], view: View, members: int) -> int:
    """Return how many members an effect is judged by: more where it strikes links at random.

    Few draws per link are few strikes, and parameters would be fitted to the draws.
    """
    return STRIKING_RICHER * members if kind.per_link and not view.waveform else members


def free_parameters(kind: type[Effect]) -> tuple[Parameter, ...]:
    """Return the parameters that are fitted.

    Not spreads over devices: the devices of recordings are few and have values of their own,
    which `bench.discrepancy.fit.per_device` finds.
    """
    return tuple(p for p in kind.parameters() if p.fitted and p.high > p.low)


def screen(objective: Objective) -> Fitted:
    """Return the best of a line search along every amplitude of the effect.

    An amplitude is a parameter with a value at which the effect does nothing; the others stay at
    their defaults. Effects without one are tried at points spread over their bounds.
    """
    thorough = not objective.view.waveform  # paths alone cost next to nothing
    several = len(objective.view.recorded.names) > 1
    for values in _starts(objective.kind, thorough, several):
        objective(values)
    if objective.best is None:
        raise BenchError(f"effect {objective.kind.name!r} gives values that are not finite")
    for values in _elsewhere(objective.kind, objective.best[1], thorough):
        objective(values)
    for values in _switched_off(objective.kind) if several and thorough else ():
        objective(values)
    return Fitted(objective.best[1], objective.best[0], objective.evaluations)


def _starts(kind: type[Effect], thorough: bool, several: bool) -> list[dict[str, float]]:
    """Return the points of the screening.

    Where `several` observables are compared, one amplitude may fit where the others do not.
    """
    plain = LINE_STEPS + FINE_LINE_STEPS if thorough else LINE_STEPS
    free = free_parameters(kind)
    amplitudes = [p for p in free if p.null is not None]
    defaults = {p.name: p.default for p in free}
    out = [defaults]
    for amplitude in amplitudes:
        null = float(amplitude.null or 0.0)
        for bound in {amplitude.low, amplitude.high} - {null}:
            at = [_between(amplitude, null, bound, step) for step in _steps(amplitude, plain)]
            out += [defaults | {amplitude.name: _inside(amplitude, value)} for value in at]
    if len(amplitudes) > 1 and several:
        out += _together(amplitudes, defaults)
    if not amplitudes:
        rng = np.random.default_rng(0)
        out += [
            {p.name: _inside(p, rng.uniform(p.low, p.high)) for p in free}
            for _ in range(SCATTERED_POINTS)
        ]
    return out


def _together(amplitudes: list[Parameter], defaults: dict[str, float]) -> list[dict[str, float]]:
    """Return points with every amplitude alone, the others off, and with all of them equally far.

    What is strong by default in one amplitude hides what little there is of another.
    """
    off = defaults | {p.name: float(p.null or 0.0) for p in amplitudes}
    ways = {p.name: (float(p.null or 0.0), max(p.low, p.high, key=_from(p))) for p in amplitudes}
    out = []
    for step in LINE_STEPS[:-1]:
        at = {p.name: _inside(p, _between(p, *ways[p.name], step)) for p in amplitudes}
        out += [off | at, *(off | {name: value} for name, value in at.items())]
    return out


def _from(item: Parameter) -> Callable[[float], float]:
    """Return how far a value is from where the effect does nothing."""
    return lambda value: abs(value - (item.null or 0.0))


def _steps(item: Parameter, plain: tuple[float, ...]) -> tuple[float, ...]:
    """Return the shares of the way from null to the bound that the line search tries."""
    if by_level(item):
        return DECIBEL_STEPS
    return RATIO_STEPS if by_ratio(item) else plain


def _elsewhere(kind: type[Effect], best: Effect, thorough: bool) -> list[dict[str, float]]:
    """Return points with the other parameters (delays, phases) spread over their bounds.

    A line search along an amplitude sees nothing where an echo's delay is wrong. Each point is
    tried at one strength in turn, or, where `thorough` or for an echo, at all.
    """
    free = free_parameters(kind)
    others = [p for p in free if p.null is None]
    amplitudes = [p for p in free if p.null is not None]
    if not others or not amplitudes:
        return []
    now = {p.name: float(getattr(best, p.name)) for p in free}
    echo = any(p.name.endswith("delay_ns") for p in others)
    points = qmc.Sobol(len(others), seed=0).random(DELAY_POINTS if echo else ELSEWHERE_POINTS)
    shares = ELSEWHERE_LEVELS if by_level(amplitudes[0]) else ELSEWHERE_SHARES
    out = []
    for number, point in enumerate(points):
        spread = {p.name: _between(p, p.low, p.high, u) for p, u in zip(others, point, strict=True)}
        for share in shares if thorough or echo else (shares[number % len(shares)],):
            strong = {p.name: _strength(p, now[p.name], share) for p in amplitudes[:1]}
            out.append(now | strong | spread)
    return out


def _switched_off(kind: type[Effect]) -> list[dict[str, float]]:
    """Return points with each parameter that may be zero at zero, one amplitude at some strengths.

    Where several observables are compared, an effect may show in one and not in the other: a wall
    delays what comes through it, and the level is held by what goes around it.
    """
    free = free_parameters(kind)
    amplitudes = [p for p in free if p.null is not None][:1]
    others = [p for p in free if p.null is None and p.low == 0]
    defaults = {p.name: p.default for p in free}
    strong = [
        {p.name: _strength(p, p.default, share)} for p in amplitudes for share in ELSEWHERE_SHARES
    ]
    return [defaults | one | {p.name: 0.0} for p in others for one in strong]


def _strength(item: Parameter, now: float, share: float | None) -> float:
    """Return the amplitude found so far, or some share of its bound."""
    null = float(item.null or 0.0)
    bound = item.high if item.high - null >= null - item.low else item.low
    return now if share is None else _between(item, null, bound, share)


def by_ratio(item: Parameter) -> bool:
    """Return whether a parameter spans decades, so that steps in it are ratios."""
    return item.low > 0 and item.high / item.low >= DECADES


def by_level(item: Parameter) -> bool:
    """Return whether a parameter is a level in decibels that starts from nothing."""
    return item.unit == "dB" and item.null == item.low and item.high - item.low >= LOUD_DB


def _between(item: Parameter, start: float, end: float, share: float) -> float:
    """Return the value that lies `share` of the way from `start` to `end`."""
    if by_ratio(item):
        return float(start * (end / start) ** share)
    return start + share * (end - start)


def valued(kind: type[Effect], values: dict[str, float]) -> Effect:
    """Return the effect with these values, whole-number parameters rounded."""
    whole = {item.name for item in fields(kind) if item.type in ("int", int)}
    return kind.from_values({k: round(v) if k in whole else v for k, v in values.items()})


def _inside(item: Parameter, value: float) -> float:
    """Return the value within the bounds."""
    return float(np.clip(value, item.low, item.high))


def refine(objective: Objective, start: Fitted, evaluations: int = EVALUATIONS) -> Fitted:
    """Return the local optimum near `start` (see `pursue` for what many parameters need)."""
    if not objective.free:
        return start
    if objective.view.waveform:
        evaluations = max(evaluations, EVALUATIONS_PER_PARAMETER * len(objective.free))
    return _descended(objective, start, evaluations)


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
    return _inside(item, float(np.exp(scaled)) if by_ratio(item) else float(scaled))


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
