"""What another simulator's table tells of its radio: period, pulse, and the noise of its CIRs.

A logged noise may be the deviation of magnitudes, of a component or of both, of few samples or of
many. What samples hold well before the first path is the noise that is in them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.physics.base import Base
from bench.physics.effect import describe
from bench.physics.scene import Scene
from bench.physics.units import Floats, Reals

BEFORE = 5.0  # samples ahead of the first path: twice as far as a pulse is wide [convention]
FEWEST = 200  # such samples, by which a power is known to 7 % [derived]
LOUD = 30.0  # times the median sample, that a peak is whose neighbours tell a width [convention]
FEWEST_PULSES = 20  # such rows, by which a width is known to a few percent [derived]
SAME_WIDTH = 0.08  # of the base's width: what detection and noise leave of one [convention]
FAR = 3.0  # times the median of rows, that one counts at most: another path may lie there


def own_base(base: Base, rows: Scene) -> Base:
    """Return the base at the sample period of a table, where it can be simulated at that."""
    return at_period(base, float(np.median(rows.number("sample_period_ns", base.sample_period_ns))))


def at_period(base: Base, period_ns: float) -> Base:
    """Return the base at a sample period, as it is where it cannot be simulated at that."""
    item = next(one for one in describe(Base) if one.name == "sample_period_ns")
    same = np.isclose(period_ns, base.sample_period_ns, rtol=1e-3)
    if same or not item.low <= period_ns <= item.high:
        return base
    return replace(base, sample_period_ns=period_ns)


def with_pulse(base: Base, magnitude: Reals, index: Floats) -> Base:
    """Return the base with pulses as wide as those of samples [n, K], where these tell.

    What reflections and tails add to a table must be as wide as its own paths, else it is another
    pulse. `index` [n] are the first paths; of rows in which they are loud: a normal curve through
    the highest sample and its neighbours.
    """
    width = pulse_width(magnitude, index)
    item = next(one for one in describe(Base) if one.name == "pulse_fwhm")
    if not np.isfinite(width) or abs(width / base.pulse_fwhm - 1) < SAME_WIDTH:
        return base
    return replace(base, pulse_fwhm=float(np.clip(width, item.low, item.high)))


def pulse_width(magnitude: Reals, index: Floats) -> float:
    """Return how wide first paths are at half of their height, in samples; NaN where untold."""
    rows, top = np.arange(len(magnitude)), magnitude.argmax(axis=1)
    near = (np.abs(top - index) < BEFORE) & (top > 0) & (top < magnitude.shape[1] - 1)
    loud = magnitude[rows, top] > LOUD * np.median(magnitude, axis=1)
    told = rows[near & loud]
    if len(told) < FEWEST_PULSES:
        return float("nan")
    sides = [np.log(np.maximum(magnitude[told, top[told] + at], 1e-12)) for at in (-1, 0, 1)]
    bend = 2 * sides[1] - sides[0] - sides[2]
    return float(np.median(np.sqrt(8 * np.log(2) / np.maximum(bend, 1e-3))))


def noise_times(magnitude: Reals, index: Floats, stated: Floats) -> float:
    """Return how many times the `stated` power [n] the noise in samples [n, K] has, 1 if untold.

    `index` [n] are the first paths. Of the weaker half of rows, as lobes lie ahead of pulses.
    """
    early = np.arange(magnitude.shape[1]) < (index - BEFORE)[:, None]
    count = early.sum(axis=1)
    highest = magnitude.max(axis=1)
    known = (count > 0) & (stated > 0) & (highest <= np.median(highest))
    if count[known].sum() < FEWEST:
        return 1.0
    power = (np.where(early, magnitude, 0).astype(np.float64) ** 2).sum(axis=1)
    ratio = power[known] / count[known] / np.median(stated[known])
    ratio = np.minimum(ratio, FAR * np.median(ratio))
    told = np.average(stated[known], weights=count[known]) / np.median(stated[known])
    found = float(np.average(ratio, weights=count[known]) / told)
    return found if found > 0 else 1.0
