"""Where the search for parameters begins: along every amplitude, and elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from bench.discrepancy.settings import (
    DECADES,
    DECIBEL_STEPS,
    DELAY_POINTS,
    ECHO_WEAKER_DB,
    ELSEWHERE_LEVELS,
    ELSEWHERE_POINTS,
    ELSEWHERE_SHARES,
    FINE_LINE_STEPS,
    LINE_STEPS,
    LOUD_DB,
    ONSET_SHARES,
    RATIO_STEPS,
    SCATTERED_POINTS,
    SCATTERED_WAVEFORMS,
    SHORTEST_ECHO_NS,
)
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]


def free_parameters(kind: type[Effect]) -> tuple[Parameter, ...]:
    """Return the parameters that are fitted.

    Not spreads over devices: the devices of recordings are few and have values of their own,
    which `bench.discrepancy.fit.per_device` finds.
    """
    return tuple(p for p in kind.parameters() if p.fitted and p.high > p.low)


def starts(kind: type[Effect], thorough: bool, several: bool) -> list[dict[str, float]]:
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
            at = [between(amplitude, null, bound, step) for step in _steps(amplitude, plain)]
            out += [defaults | {amplitude.name: inside(amplitude, value)} for value in at]
    if len(amplitudes) > 1 and several:
        out += _together(amplitudes, defaults)
    count = SCATTERED_POINTS if thorough else SCATTERED_WAVEFORMS
    return out if amplitudes else out + _scattered(free, count)


def begun(kind: type[Effect]) -> list[dict[str, float]]:
    """Return points along the first amplitude from where else a search begins."""
    free = free_parameters(kind)
    defaults = {p.name: p.default for p in free}
    first = [p for p in free if p.null is not None][:1]
    return [
        defaults | dict(begin) | {p.name: inside(p, between(p, float(p.null or 0), p.high, step))}
        for begin in kind.begins
        for p in first
        for step in _steps(p, LINE_STEPS)
    ]


def _scattered(free: tuple[Parameter, ...], count: int) -> list[dict[str, float]]:
    """Return points spread evenly over all bounds, by ratio where these span decades.

    Nothing is known of an effect without an amplitude, and its parameters make up for each other: a
    body that is narrow and one that is wide, whose edges send more, take as much of a level.
    """
    points = qmc.Sobol(len(free), seed=0).random_base2(count.bit_length() - 1) if free else ()
    pairs = (zip(free, point, strict=True) for point in points)
    return [{p.name: between(p, p.low, p.high, float(u)) for p, u in pair} for pair in pairs]


def _together(amplitudes: list[Parameter], defaults: dict[str, float]) -> list[dict[str, float]]:
    """Return points with every amplitude alone, the others off, and with all of them equally far.

    What is strong by default in one amplitude hides what little there is of another.
    """
    off = defaults | {p.name: float(p.null or 0.0) for p in amplitudes}
    ways = {p.name: (float(p.null or 0.0), max(p.low, p.high, key=_from(p))) for p in amplitudes}
    out = []
    for step in LINE_STEPS[:-1]:
        at = {p.name: inside(p, between(p, *ways[p.name], step)) for p in amplitudes}
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


def onsets(
    kind: type[Effect], points: Sequence[Mapping[str, float]], much: Sequence[bool | None]
) -> list[dict[str, float]]:
    """Return points between what does nothing and what does too much, along every amplitude.

    A threshold does nothing for long, and far too much a step later. `much`: whether a point does
    more than recordings show, None where it does nothing.
    """
    defaults = {p.name: p.default for p in free_parameters(kind)}
    out = []
    for item in (p for p in free_parameters(kind) if p.null is not None):
        line = {
            point[item.name]: did
            for point, did in zip(points, much, strict=True)
            if point == defaults | {item.name: point[item.name]} and point != defaults
        }
        for side in (-1.0, 1.0):
            values = sorted((v for v in line if side * (v - (item.null or 0)) > 0), key=_from(item))
            for last, first in pairwise(values):
                if line[last] is None and line[first]:
                    at = (between(item, last, first, share) for share in ONSET_SHARES)
                    out += [defaults | {item.name: inside(item, value)} for value in at]
    return out


def elsewhere(kind: type[Effect], best: Effect, thorough: bool) -> list[dict[str, float]]:
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
    if echo:
        points = _delays(points, others)
    shares = ELSEWHERE_LEVELS if by_level(amplitudes[0]) else ELSEWHERE_SHARES
    out = []
    for number, point in enumerate(points):
        spread = {p.name: between(p, p.low, p.high, u) for p, u in zip(others, point, strict=True)}
        for share in shares if thorough or echo else (shares[number % len(shares)],):
            strong = {p.name: _strength(p, now[p.name], share) for p in amplitudes[:1]}
            out.append(now | strong | spread)
    return out


def delayed(kind: type[Effect], best: Effect) -> list[dict[str, float]]:
    """Return points with nothing but the delay of an echo elsewhere, at two strengths."""
    free = free_parameters(kind)
    now = {p.name: float(getattr(best, p.name)) for p in free}
    levels = [p for p in free if by_level(p)][:1]
    weaker = {p.name: inside(p, now[p.name] - ECHO_WEAKER_DB) for p in levels}
    ratios = np.linspace(0, 1, DELAY_POINTS)
    return [
        now | other | {p.name: SHORTEST_ECHO_NS * (p.high / SHORTEST_ECHO_NS) ** ratio}
        for p in free
        if p.name.endswith("delay_ns")
        for ratio in ratios
        for other in ({}, weaker)
    ]


def _delays(points: Floats, others: list[Parameter]) -> Floats:
    """Return points [n, k] of the unit cube whose delays are spread evenly by ratio.

    Echoes are short, and a start that is off by more than a pulse leads nowhere.
    """
    ratios = np.linspace(0, 1, len(points))
    for column, item in enumerate(others):
        if item.name.endswith("delay_ns"):
            delays = SHORTEST_ECHO_NS * (item.high / SHORTEST_ECHO_NS) ** ratios
            points[:, column] = (delays - item.low) / (item.high - item.low)
    return points


def switched_off(kind: type[Effect]) -> list[dict[str, float]]:
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
    return now if share is None else between(item, null, bound, share)


def by_ratio(item: Parameter) -> bool:
    """Return whether a parameter spans decades, so that steps in it are ratios."""
    return item.low > 0 and item.high / item.low >= DECADES


def by_level(item: Parameter) -> bool:
    """Return whether a parameter is a level in decibels that starts from nothing."""
    return item.unit == "dB" and item.null == item.low and item.high - item.low >= LOUD_DB


def between(item: Parameter, start: float, end: float, share: float) -> float:
    """Return the value that lies `share` of the way from `start` to `end`."""
    if by_ratio(item):
        return float(start * (end / start) ** share)
    return start + share * (end - start)


def share_between(item: Parameter, start: float, end: float, value: float) -> float:
    """Return which share of the way from `start` to `end` a value lies: `between` turned round."""
    if by_ratio(item):
        return float(np.log(value / start) / np.log(end / start))
    return (value - start) / (end - start)


def inside(item: Parameter, value: float) -> float:
    """Return the value within the bounds."""
    return float(np.clip(value, item.low, item.high))
