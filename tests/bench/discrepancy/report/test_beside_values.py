"""Beside listed values: slopes of crystals, and of which walls delays and losses are."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.report.beside_values import beside_values, slope_lines
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.device_values import beside_middle
from bench.physics.effects.fitted.wall_delay import WallDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.materials import obstacle
from bench.physics.slabs import UNLISTED


def test_slopes_over_degrees_and_hours_are_said_beside_middling_devices() -> None:
    devices, zeros = ("a", "b", "t"), (0.0, 0.0, 0.0)
    steady = DeviceClock(devices, (0.1, 0.2, 0.3), zeros)
    assert slope_lines(steady) == slope_lines(RangeScale()) == []
    slopes = (-0.125, 0.0, 0.25)
    (warm,) = slope_lines(DeviceClock(devices, zeros, zeros, slopes_ppm_per_c=slopes))
    assert "ppm per degC beside middling devices" in warm
    assert "t 0.25, a -0.125, b 0; offsets are those at 25 degC" in warm
    (late,) = slope_lines(DeviceClock(devices, zeros, (0.0, 0.5, 0.0), reference_s=60.0))
    assert "ppm per hour" in late
    assert "b 0.5" in late


def test_delays_say_how_thick_their_walls_are_and_what_these_lose() -> None:
    walls = WallDelay(("brick", UNLISTED), (0.14, 0.2), (5.5, 0.0))
    thick, lost = beside_values(walls)
    assert thick.endswith(f"as thick as: brick {obstacle('brick').thickness_m:.3g} m")
    assert f"brick 5.5 dB, {UNLISTED} 0 dB" in lost
    assert beside_values(RangeScale()) == []


def test_offsets_are_beside_middling_devices_and_not_the_one_in_the_middle() -> None:
    """What is wrong with one device is not what is wrong with all."""
    offsets = (0.4, -0.1, 0.0, 0.1, 0.02, -0.02, 9.0)
    made = beside_middle(offsets)
    assert made[2] == pytest.approx(-(0.0 + 0.02 + 0.1) / 3)
    assert beside_middle((1.0, 5.0, 2.0)).tolist() == [-1.0, 3.0, 0.0]
    assert beside_middle(()).size == 0
    several = np.random.default_rng(2).normal(size=(400, 23))
    shared = np.mean(several - [beside_middle(one) for one in several], axis=1)
    alone = np.median(several, axis=1)
    assert shared.std() < 0.97 * alone.std()
