"""Crystals make a proportion of the reply time; of one reply time alone they are delays."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.sets.blocks import deformed, off_by
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.ranging.clock_offset import ClockOffset
from tests.bench.discrepancy.sets.test_deformed import seen
from tests.bench.discrepancy.sets.test_same_rows import PER_PPM_AND_S, names_of, rows_of


def test_a_delay_beside_the_crystal_of_one_device_has_its_name() -> None:
    """A deformation over the reply time had made a constant of what the crystal does."""
    frame = rows_of(6)
    own = np.where(frame["tx"] == "t1", 1.8, 0.0) * PER_PPM_AND_S * frame["reply_time_s"]
    assert names_of(frame, (0.08 + own).to_numpy()) == {"antenna-delay", "clock-offset"}


def test_a_late_device_beside_a_drift_is_no_crystal_alone_where_replies_are_alike() -> None:
    frame = rows_of(7, reply_time_s=1e-3)
    warm = np.random.default_rng(3).uniform(5, 35, len(frame))
    shift_m = np.where(frame["rx"] == "a2", 0.15, 0.0) + 4e-3 * (warm - 25)
    open_ones = names_of(frame.assign(temperature_c=warm), shift_m)
    assert open_ones == {"antenna-delay", "clock-offset", "temperature-drift"}


def test_what_crystals_make_is_bent_by_time_and_temperature_alone() -> None:
    rows = seen()
    response = np.linspace(-0.1, 0.1, len(rows.rows))
    assert not off_by(response, rows, ClockOffset).any()
    assert deformed(response, rows, ClockOffset).shape[1] < deformed(response, rows).shape[1]


def test_one_device_that_is_off_leaves_the_others_at_zero() -> None:
    clock = DeviceClock(("a", "b", "c"), (0.1, 0.1, 1.9), (0.0, 0.0, 0.0))
    assert list(clock.values().values()) == pytest.approx([0.0, 0.0, 1.8])
