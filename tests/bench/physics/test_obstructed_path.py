"""Obstructed links: weaker, later, emptier before the detour; free ones untouched."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.base import Base
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 40


def _frame(**columns: object) -> pd.DataFrame:
    link = np.repeat(np.arange(LINKS), 4)
    return pd.DataFrame({"link": [f"l{i}" for i in link], "true_range_m": 4.0, **columns})


def _seen(*effects: object, **columns: object):
    return Simulator(Base(), tuple(effects)).observe(scene(_frame(**columns)), 1)


def test_no_share_no_change() -> None:
    plain, struck = _seen(), _seen(ObstructedPath(share=0.0))
    assert np.array_equal(plain.cir, struck.cir)


def test_obstructed_links_lose_power_and_read_long() -> None:
    plain = _seen()
    struck = _seen(ObstructedPath(share=1.0, loss_db=15, loss_spread_db=0, delay_m=0.3))
    lost = plain.first_path_power_dbm - struck.first_path_power_dbm
    assert np.median(lost) == pytest.approx(15, abs=1)
    assert np.median(struck.error_m - plain.error_m) == pytest.approx(0.3, abs=0.03)


def test_the_delay_may_differ_between_links_but_not_within_one() -> None:
    plain = _seen()
    struck = _seen(
        ObstructedPath(share=1.0, loss_db=3, loss_spread_db=0, delay_m=0.3, delay_spread=1)
    )
    late = (struck.error_m - plain.error_m).reshape(LINKS, 4)
    assert late.mean() == pytest.approx(0.3, abs=0.15)
    assert late.mean(axis=1).std() > 0.15
    assert np.median(late.std(axis=1)) < 0.02


def test_where_the_straight_path_is_lost_the_detour_is_ranged() -> None:
    tail = DiffuseTail(level_db=-8, distance_exponent=0)
    gone = ObstructedPath(share=1.0, loss_db=60, loss_spread_db=0, common=0, detour_m=1.0)
    error = _seen(tail, gone).error_m
    per_link = np.median(error.reshape(LINKS, 4), axis=1)
    assert per_link.min() > -0.4
    assert 0.5 < per_link.mean() < 2.5
    assert per_link.std() > 0.4


def test_it_acts_behind_the_other_effects_however_listed() -> None:
    tail, struck = DiffuseTail(level_db=-8), ObstructedPath(share=1.0, loss_db=40, detour_m=2.0)
    assert np.array_equal(_seen(tail, struck).cir, _seen(struck, tail).cir)


def test_rows_with_sight_are_left_alone() -> None:
    sight = np.repeat(np.arange(LINKS) % 2 == 0, 4)
    plain, struck = _seen(los=sight), _seen(ObstructedPath(share=1.0), los=sight)
    same = np.all(plain.cir == struck.cir, axis=1)
    assert same[sight].all()
    assert not same[~sight].any()
