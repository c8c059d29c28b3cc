"""What the gasworks' pipes and meters do to late parts: what they are said to do."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.families.gasworks_oddities import (
    CORED,
    DOUBLES,
    FALLS,
    SINKS,
    STAIR,
    cored,
    doubled,
    foreshown,
    held,
    mingled,
    stairs,
    thirds,
)


def test_orders_of_late_sizes_are_what_they_say() -> None:
    some = np.arange(20.0)
    assert thirds(some)[:9].tolist() == [6, 7, 8, 3, 4, 5, 0, 1, 2]
    assert thirds(some)[18:].tolist() == [18, 19]
    assert held(some)[:9].tolist() == [0, 0, 0, 0, 4, 4, 4, 4, 8]
    assert len(held(np.arange(18.0))) == 18


def test_sizes_of_late_sizes_are_what_they_say() -> None:
    some = np.random.default_rng(2).gamma(2.0, 50.0, 120)
    assert np.allclose(mingled(some)[:-3] ** 2, some[:-3] * some[3:])
    assert np.allclose(mingled(some)[-3:], some[-3:])
    less = cored(some)
    assert np.allclose(less, np.maximum(some - CORED * np.median(some), 0.02 * some))
    steps = np.log(doubled(some) / np.median(some)) / np.log(DOUBLES)
    assert np.allclose(steps, np.rint(steps))
    assert np.abs(np.log(doubled(some) / some)).max() <= 0.5 * np.log(DOUBLES) + 1e-9
    gain = stairs(some) / some
    assert np.allclose(gain[:STAIR], 1.0)
    assert np.allclose(gain[2 * STAIR : 3 * STAIR], SINKS**2)
    assert np.allclose(gain[3 * STAIR : 4 * STAIR], 1.0)


def test_a_needle_that_falls_slowly_shows_crests_before_they_come() -> None:
    some = np.ones(60)
    some[40] = 100.0
    made = foreshown(some)
    assert made.mean() == pytest.approx(some.mean())
    assert made[30] / made[40] == pytest.approx(FALLS**10)
    assert made[41] / made[40] == pytest.approx(0.01)
