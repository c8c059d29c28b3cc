"""A crystal that wanders: an Ornstein-Uhlenbeck process between the knots where it is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.physics.units import Floats


def bridge(time: Floats, knots: Floats, values: Floats, settle: float) -> tuple[Floats, Floats]:
    """Return mean and variance [n] of an Ornstein-Uhlenbeck process given its `values` at `knots`.

    Unit stationary variance, time constant `settle`, all times in one unit. Only the two knots
    around a time count (it is a Markov process): the normal distribution given both.
    """
    after = np.searchsorted(knots, time)
    left, right = (np.clip(after + move, 0, len(knots) - 1) for move in (-1, 0))
    a = np.where(after > 0, np.exp(-np.abs(time - knots[left]) / settle), 0.0)
    b = np.where(after < len(knots), np.exp(-np.abs(time - knots[right]) / settle), 0.0)
    both = np.where((a > 0) & (b > 0), np.exp(-(knots[right] - knots[left]) / settle), 0.0)
    room = np.maximum(1 - both**2, 1e-12)
    weights = (a - b * both) / room, (b - a * both) / room
    mean = weights[0] * values[left] + weights[1] * values[right]
    return mean, np.clip(1 - weights[0] * a - weights[1] * b, 0.0, 1.0)


def nearest(knots: Floats, time: Floats) -> NDArray[np.intp]:
    """Return the position of the knot nearest to each time [n]."""
    middles = (knots[1:] + knots[:-1]) / 2
    return np.searchsorted(middles, time)
