"""A fitted value with its interval."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from math import inf

from bench.physics.effect import Effect, Parameter
from bench.text import significant

PURE = ("1", "ratio")  # numbers without a unit


@dataclass(frozen=True)
class ParameterEstimate:
    """A fitted parameter with its 90 % interval, and whether it stopped at a physical bound.

    Not `determined`: the recordings leave it anywhere within its bounds.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str
    at_bound: bool = False
    determined: bool = True

    def __str__(self) -> str:
        if not self.determined:
            return f"{self.name}: not determined by these recordings"
        edge = " (at its physical bound)" if self.at_bound else ""
        unit = "" if self.unit in PURE else f" {self.unit}"
        value, low, high = (significant(one, 4) for one in (self.value, self.low, self.high))
        return f"{self.name} = {value} [{low}, {high}]{unit}{edge}"


def within_bounds(item: ParameterEstimate, effect: Effect) -> ParameterEstimate:
    """Return an estimate with its interval cut at the physical bounds of the parameter."""
    bounds = {p.name: (p.low, p.high) for p in effect.parameters()}
    low, high = bounds.get(item.name, (-inf, inf))
    return replace(item, low=max(item.low, low), high=min(item.high, high))


def profiled(
    item: Parameter, value: float, near: Collection[float], grid: Sequence[float]
) -> ParameterEstimate:
    """Return a parameter that was tried on a grid, values `near` being about as likely.

    Its interval ends half way to the next value on either side.
    """
    low, high = _half_way(min(near), max(near), [item.low, *grid, item.high])
    return ParameterEstimate(item.name, value, low, high, item.unit, value >= item.high)


def _half_way(low: float, high: float, grid: Sequence[float]) -> tuple[float, float]:
    """Return the ends of a stretch of a grid, half way to the values beside it."""
    below = max((one for one in grid if one < low), default=low)
    above = min((one for one in grid if one > high), default=high)
    return (below + low) / 2, (high + above) / 2
