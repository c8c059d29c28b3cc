"""The grammar: forms of laws over one covariate, each with units, as numbers, text and words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.material import Column, Material, base_values
from bench.discrepancy.law.settings import (
    LAW_AT_ONCE,
    LAW_CYCLE_STEP,
    LAW_CYCLES,
    LAW_FEW_TURNS,
    LAW_FEWEST_PLACES,
    LAW_GRID_P,
    LAW_HARMONICS,
    LAW_NYQUIST,
    LAW_ONE_PHASE,
    LAW_POWER_BOUNDS,
    LAW_POWERS,
    LAW_SATURATION,
    LAW_SCALES,
    LAW_SPREAD,
    LAW_STEP_SHARE,
    LAW_STEPS,
    LAW_TAU,
)
from bench.physics.formula.units import over, times

Floats = NDArray[np.float64]
Named = tuple[str, float, str]
TURN = 2 * np.pi


@dataclass(frozen=True)
class Form:
    """One form of law over a covariate.

    `text` is its expression and `words` the same for people, with {x} for the covariate and its
    constants by name. `grid` gives the values of its one non-linear constant `free` that are
    screened, [0] where it has none, nothing where the form cannot show. `basis` maps covariate [n]
    and free values [G] to its linear parts, each [G, n]; `named` names its constants.
    """

    name: str
    text: str
    words: str
    grid: Callable[[Column], Floats]
    basis: Callable[[Column, Floats], tuple[Floats, ...]]
    named: Callable[[Column, str, float, Floats], list[Named]]
    free: str = ""
    smooth: bool = True
    offset: tuple[bool, ...] = (False, True)

    def bounds(self, screened: Floats, value: float) -> tuple[float, float]:
        """Return between which values the free constant is searched around a screened one."""
        grid = np.sort(screened)
        at = int(np.argmin(np.abs(grid - value)))
        low, high = grid[max(at - 1, 0)], grid[min(at + 1, len(grid) - 1)]
        if self.name == "power":
            least = LAW_POWER_BOUNDS[0] if grid[0] < 0 else grid[0]  # no pole at zero
            low, high = max(value - 1, least), min(value + 1, LAW_POWER_BOUNDS[1])
        return float(low), float(high)


def _once(_: Column) -> Floats:
    return np.zeros(1)


def _unless_angle(column: Column) -> Floats:
    return np.zeros(0 if column.angle else 1)


def _positive(column: Column) -> bool:
    """Return whether a covariate is a positive size that varies enough for its powers to show."""
    low, high = np.nanmin(column.values), np.nanmax(column.values)
    return bool(not column.angle and low > 0 and high > LAW_SPREAD * low)


def _if_positive(column: Column) -> Floats:
    return np.zeros(1 if _positive(column) else 0)


def _from_zero(column: Column) -> bool:
    """Return whether a covariate is a count or size of which some rows have none."""
    over_zero = column.values[column.values > 0]
    wide = len(over_zero) > 0 and over_zero.max() > LAW_SPREAD * over_zero.min()
    return bool(not column.angle and np.nanmin(column.values) == 0 and wide)


def _powers(column: Column) -> Floats:
    powers = np.array(LAW_POWERS, np.float64)
    if _from_zero(column):
        return powers[powers > 0]
    return powers[: len(powers) * _positive(column)]


def _saturations(column: Column) -> Floats:
    if not (_positive(column) or _from_zero(column)):
        return np.empty(0)
    low, high = np.min(column.values[column.values > 0]), np.nanmax(column.values)
    return np.geomspace(LAW_SATURATION[0] * low, LAW_SATURATION[1] * high, LAW_SCALES)


def _counts(column: Column) -> Floats:
    return _saturations(column) if _from_zero(column) else np.empty(0)


def _taus(column: Column) -> Floats:
    if column.unit != "s" or column.text != "time_s":
        return np.empty(0)
    span = float(np.ptp(column.values[np.isfinite(column.values)]))
    return np.geomspace(LAW_TAU[0] * span, LAW_TAU[1] * span, LAW_SCALES)


def _places(column: Column) -> Floats:
    """Return places between different values, with enough rows on either side."""
    if column.angle:
        return np.empty(0)
    known = np.sort(column.values[np.isfinite(column.values)])
    at = np.linspace(LAW_STEP_SHARE, 1 - LAW_STEP_SHARE, LAW_STEPS)
    below = known[np.asarray(at * (len(known) - 1), np.intp)]
    above = np.searchsorted(known, below, side="right")
    inside = above < len(known)
    return np.unique((below[inside] + known[above[inside]]) / 2)


def _periods(column: Column) -> Floats:
    """Return periods of times and distances that go round several times; else harmonics."""
    if column.angle or column.unit not in ("s", "m"):
        return np.empty(0)
    known = np.unique(column.values[np.isfinite(column.values)])
    if len(known) < LAW_FEWEST_PLACES:
        return np.empty(0)
    span = float(known[-1] - known[0])
    most = min(LAW_CYCLES[1], len(known) / 2)
    every = span / np.arange(LAW_CYCLES[0], max(most, LAW_CYCLES[0] + 1), LAW_CYCLE_STEP)
    return every[every > LAW_NYQUIST * spacing_of(known, float(every[-1]) / LAW_NYQUIST)]


def spacing_of(values: Floats, least: float) -> float:
    """Return the spacing of sorted places [n] that lie on a grid, 0 where it is below `least`.

    Places a metre apart show no period of less than two metres: it would be something slower
    (Nyquist).
    """
    span = float(values[-1] - values[0])
    short = span / np.arange(LAW_FEW_TURNS, span / least, LAW_CYCLE_STEP)
    alike = short[_resultants(values, short) > LAW_ONE_PHASE]
    found = [p for p in alike if _on_grid(values, float(p), LAW_GRID_P / len(short))]
    return float(max(found, default=0.0))


def _on_grid(values: Floats, period: float, level: float) -> bool:
    """Return whether sorted places [n] are of one phase, and not by chance at this level.

    Places closer than half a period are one: a batch of rows within a second has one phase. Of n
    random phases the resultant length is above r with about (1 - r^2)^(n - 1): Rayleigh's exp(-n
    r^2) of many, and none above 1. It is too sure of fewer than eight, which show no period.
    """
    place = np.cumsum(np.diff(values, prepend=values[0]) > period / 2)
    count = np.bincount(place)
    middle = np.bincount(place, values) / count
    every = np.array([period])
    length = float(min(_resultants(values, every)[0], _resultants(middle, every)[0]))
    chance = max(1 - length**2, 0.0) ** (len(count) - 1)
    return length > LAW_ONE_PHASE and chance < level


def _resultants(values: Floats, periods: Floats) -> Floats:
    """Return how far places [n] are of one phase of each period [P]: 1 all, 0 none of them."""
    return wave_sums(values, periods, np.full(len(values), 1 / len(values)))


def wave_sums(values: Floats, periods: Floats, weights: Floats) -> Floats:
    """Return |sum of weights x a wave| of each period [P] over places [n], in blocks of periods.

    Thousands of periods times thousands of places would take a gigabyte.
    """
    blocks = np.split(TURN / periods, np.arange(LAW_AT_ONCE, len(periods), LAW_AT_ONCE))
    return np.concatenate([np.abs(np.exp(1j * np.outer(one, values)) @ weights) for one in blocks])


def _harmonics(column: Column) -> Floats:
    return np.array(LAW_HARMONICS if column.angle else (), np.float64)


def _with(function: Callable[[Floats, Floats], Floats]) -> Callable[..., tuple[Floats, ...]]:
    """Return a basis of one part from a function of values [1, n] and free constants [G, 1]."""
    return _scaled(lambda _, x, free: function(x, free))


def _scaled(function: Callable[[Column, Floats, Floats], Floats]) -> Callable[..., tuple[Floats]]:
    """Return a basis of one part that knows the covariate's reference."""

    def basis(column: Column, free: Floats) -> tuple[Floats]:
        with np.errstate(all="ignore"):
            made = function(column, column.values[None, :], np.asarray(free)[:, None])
        shape = (len(free), len(column.values))
        return (np.nan_to_num(np.broadcast_to(made, shape), posinf=0, neginf=0),)

    return basis


def _waves(column: Column, free: Floats) -> tuple[Floats, ...]:
    """Return sine and cosine [G, n] of a period."""
    return _sine_and_cosine(TURN * column.values[None, :] / np.asarray(free)[:, None])


def _turns(column: Column, free: Floats) -> tuple[Floats, ...]:
    """Return sine and cosine [G, n] of a multiple of an angle."""
    return _sine_and_cosine(np.asarray(free)[:, None] * base_values(column)[None, :])


def _sine_and_cosine(phase: Floats) -> tuple[Floats, Floats]:
    return np.nan_to_num(np.sin(phase)), np.nan_to_num(np.cos(phase))


def _start(column: Column) -> float:
    return float(np.nanmin(column.values))


def _amplitude(unit_of: Callable[[str, str], str]) -> Callable[..., list[Named]]:
    """Return what names an amplitude alone; `unit_of`(metres over the factor, covariate)."""

    def named(column: Column, top: str, _: float, found: Floats) -> list[Named]:
        return [("a", float(found[0]), unit_of(top, column.unit))]

    return named


def _and(*more: Callable[[Column, float], Named]) -> Callable[..., list[Named]]:
    """Return what names an amplitude in metres and further constants."""

    def named(column: Column, top: str, free: float, found: Floats) -> list[Named]:
        return [("a", float(found[0]), top), *(one(column, free) for one in more)]

    return named


def _waving(name: str) -> Callable[..., list[Named]]:
    """Return what names amplitude, phase and period (or harmonic)."""

    def named(column: Column, top: str, free: float, found: Floats) -> list[Named]:
        size, phase = float(np.hypot(*found[:2])), float(np.arctan2(found[1], found[0]))
        period = (name, free, column.unit if name == "period" else "1")
        return [("a", size, top), period, ("phase", phase, "rad")]

    return named


FORMS: tuple[Form, ...] = (
    Form("linear", "a * {x}", "{a} of {x}", _unless_angle,
         _with(lambda x, _: x), _amplitude(over)),
    Form("inverse", "a / {x}", "{a} / {x}", _if_positive,
         _with(lambda x, _: 1 / x), _amplitude(times)),
    Form("inverse square", "a / {x} ** 2", "{a} / ({x})^2", _if_positive,
         _with(lambda x, _: x**-2.0), _amplitude(lambda top, own: times(top, own, own))),
    Form("power", "a * ({x} / x0) ** p", "{a} x ({x} / {x0})^{p}", _powers,
         _scaled(lambda c, x, free: (x / c.reference) ** free),
         _and(lambda c, _: ("x0", c.reference, c.unit), lambda _, free: ("p", free, "1")), "p"),
    Form("logarithm", "a * log({x} / x0)", "{a} x ln({x} / {x0})", _if_positive,
         _scaled(lambda c, x, _: np.log(x / c.reference)),
         _and(lambda c, _: ("x0", c.reference, c.unit)), offset=(True,)),
    Form("logarithm", "a * log(1 + {x} / x0)", "{a} x ln(1 + {x} / {x0})", _counts,
         _with(lambda x, free: np.log1p(x / free)), _and(lambda c, free: ("x0", free, c.unit)),
         "x0"),
    Form("parabola", "a * ({x} - x0) ** 2", "{a} x ({x} - {x0})^2", _places,
         _with(lambda x, free: (x - free) ** 2),
         lambda c, top, free, found: [("a", float(found[0]), over(top, c.unit, c.unit)),
                                      ("x0", free, c.unit)], "x0"),
    Form("saturation", "a * {x} / ({x} + x0)", "{a} x {x} / ({x} + {x0})", _saturations,
         _with(lambda x, free: x / (x + free)), _and(lambda c, free: ("x0", free, c.unit)), "x0"),
    Form("relaxation", "a * exp(-({x} - x0) / tau)", "{a} x exp(-({x} - {x0}) / {tau})", _taus,
         _scaled(lambda c, x, free: np.exp(-(x - _start(c)) / free)),
         _and(lambda c, _: ("x0", _start(c), c.unit), lambda c, free: ("tau", free, c.unit)),
         "tau"),
    Form("step", "a * ({x} > x0)", "{a} where {x} is above {x0}", _places,
         _with(lambda x, free: np.where(x > free, 1.0, 0.0)),
         _and(lambda c, free: ("x0", free, c.unit)), "x0", smooth=False),
    Form("step", "a * ({x} < x0)", "{a} where {x} is below {x0}", _places,
         _with(lambda x, free: np.where(x < free, 1.0, 0.0)),
         _and(lambda c, free: ("x0", free, c.unit)), "x0", smooth=False, offset=(False,)),
    Form("periodic", f"a * sin({TURN!r} * {{x}} / period + phase)",
         "{a} x sin(2 pi {x} / {period} + {phase})", _periods, _waves, _waving("period"), "period"),
    Form("periodic", "a * sin(k * {x} + phase)", "{a} x sin({k} x {x} + {phase})", _harmonics,
         _turns, _waving("k"), "k", smooth=False),
)  # fmt: skip
CONSTANT = Form(
    "constant", "a", "{a}", _once, _with(lambda x, _: np.ones_like(x)),
    _amplitude(lambda top, _: top), offset=(False,),
)  # fmt: skip


def nowhere(rows: int) -> Column:
    """Return the covariate of a law that is over none."""
    return Column("1", "", "1", np.ones(rows), 1.0)


def over_what(given: Material, at: int) -> Column:
    """Return a covariate by number; -1 is none."""
    return nowhere(len(given.residual_m)) if at < 0 else given.columns[at]
