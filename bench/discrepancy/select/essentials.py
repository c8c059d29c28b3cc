"""Parameters that an effect is nothing without: whether they do anything, in words."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.settings import DECADES, ESSENTIAL_SHARE
from bench.physics.effect import Effect, Parameter


def unused(effect: Effect) -> str:
    """Return in words which parameter essential with waveforms does nothing, "" where none."""
    needed = (p for p in effect.parameters() if p.name in type(effect).essential_with_cir)
    near = (p for p in needed if abs(getattr(effect, p.name) - (p.null or 0.0)) < _close(p))
    return next((f"without its {p.name} it would do as well" for p in near), "")


def _close(item: Parameter) -> float:
    """Return how near its null a parameter does nothing."""
    return ESSENTIAL_SHARE * (item.high - item.low)


def idle(item: Parameter, found: ParameterEstimate, needed: bool = False) -> str:
    """Return in words whether a parameter may do nothing, or would go beyond physics, else "".

    `needed`: evidence says that it does something, whatever its interval.
    """
    null, close = _along(item, float(item.null or 0.0)), ESSENTIAL_SHARE
    value, low, high = (_along(item, one) for one in (found.value, found.low, found.high))
    none = not found.determined or abs(value - null) < close or low <= null <= high
    if none and not needed:
        return f"without its {item.name} it would do as well"
    if min(value, 1 - value) < close:
        return f"only with its {item.name} at the bound of physics"
    return ""


def _along(item: Parameter, value: float) -> float:
    """Return where between its bounds a parameter is, 0 to 1; by ratio where they are decades."""
    if item.low > 0 and item.high > DECADES * item.low:
        return float(np.log(value / item.low) / np.log(item.high / item.low))
    return (value - item.low) / (item.high - item.low)
