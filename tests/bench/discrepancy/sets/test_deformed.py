"""A cause may have another form only as far as its physics leaves it one."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.sets.blocks import deformed, off_by
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.temperature import TemperatureDrift
from tests.bench.discrepancy.sets.test_same_rows import rows_of


def seen(**more: float) -> View:
    """Return a view of rows in which the distance and more vary."""
    frame = rows_of(3).assign(**more)
    frame = frame.assign(temperature_c=np.linspace(10, 30, len(frame)), error_m=0.0)
    frame = frame.assign(range_m=frame["true_range_m"])
    return view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)


def follows_distance(rows: View, columns: np.ndarray, response: np.ndarray) -> float:
    """Return the share of response x distance that the columns make."""
    far = rows.scene.true_range_m
    wanted = response * (far - far.mean())
    left = wanted - columns @ np.linalg.lstsq(columns, wanted, rcond=None)[0]
    return float(1 - left.var() / wanted.var())


def test_what_clocks_make_is_of_one_size_at_all_distances() -> None:
    rows = seen()
    warm = np.linspace(-0.1, 0.1, len(rows.rows))
    drift, pattern = (deformed(warm, rows, of) for of in (TemperatureDrift, AntennaPattern))
    assert follows_distance(rows, pattern, warm) > 0.9
    assert follows_distance(rows, drift, warm) < 0.7  # devices stand at some distances by chance
    assert off_by(warm, rows, TemperatureDrift).shape[1] == 1
    assert off_by(warm, rows, GroundBounce).shape[1] == 2


def test_a_pattern_is_the_same_at_all_distances() -> None:
    rows = seen()
    over_heading = np.cos(np.arange(len(rows.rows)))
    off = off_by(over_heading, rows, AntennaPattern)
    assert off.shape[1] == 1  # its mean depends on the make, and a line over the distance is none
    assert np.ptp(off) == pytest.approx(0.0)


def test_what_follows_a_level_is_of_one_size_at_all_distances() -> None:
    """Else a bias of the level does for the scale that stands beside it (two tables did)."""
    rows = seen()
    bias = np.tanh(np.linspace(-2, 2, len(rows.rows)))
    assert follows_distance(rows, deformed(bias, rows, GroundBounce), bias) > 0.9
    assert follows_distance(rows, deformed(bias, rows, PowerBias), bias) < 0.7
    assert off_by(bias, rows, PowerBias).shape[1] == 1


def test_where_nothing_is_in_the_way_a_wall_is_off_by_nothing() -> None:
    rows = seen()
    walls = np.where(np.arange(len(rows.rows)) % 3 == 0, 0.2, 0.0)
    assert not off_by(walls, rows)[walls == 0].any()
    assert off_by(walls, rows)[walls > 0].any()


def test_a_curve_that_was_not_calibrated_moves_no_row_in_which_the_effect_does_nothing() -> None:
    """Of a response with a long tail it would be a constant in all other rows."""
    rows = seen()
    seldom = np.where(np.arange(len(rows.rows)) % 10 == 0, 0.7, 0.0)
    assert deformed(seldom, rows)[seldom == 0].any()
    assert not deformed(seldom, rows, calibrated=False)[seldom == 0].any()
