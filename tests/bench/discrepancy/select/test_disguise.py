"""A curve that is level where rows are is no second explanation beside its constant."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.view import View
from bench.discrepancy.select.disguise import without_disguises
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.fitted.power_curve import PowerCurve
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.scene import scene

LEVELS_DBM = tuple(np.arange(-97.0, -50.0, 3.0))


def option(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), Estimate(2.0, 1.9, 2.1), 1.0, Control("", None))


def curve(*ends_m: float) -> LeftOut:
    bias_m = np.full(len(LEVELS_DBM), 0.11)
    bias_m[-len(ends_m) :] = ends_m
    bias_m[:4] = 0.2, 0.18, 0.16, 0.13  # no row is as weak
    assert LEVELS_DBM[4] == -85
    return option(PowerCurve(LEVELS_DBM, tuple(bias_m)))


def rows(spread_db: float) -> View:
    levels = np.linspace(-85, -85 + spread_db, 50)
    recorded = SimpleNamespace(names=("rx_power_dbm",), column=lambda _: levels)
    return cast(View, SimpleNamespace(recorded=recorded))


def test_a_curve_that_bends_only_at_its_ends_is_level() -> None:
    delay = option(AntennaDelay(delay_ns=0.77))
    assert without_disguises((delay, curve(0.092)), rows(25)) == (delay,)


def test_a_curve_that_bends_stays() -> None:
    delay, bent = option(AntennaDelay(delay_ns=0.77)), curve(*np.linspace(0.1, 0.0, 10))
    assert without_disguises((delay, bent), rows(25)) == (delay, bent)


def test_a_level_curve_stays_where_rows_have_one_level_or_it_leads() -> None:
    delay = option(AntennaDelay(delay_ns=0.77))
    assert len(without_disguises((delay, curve(0.092)), rows(3))) == 2
    assert len(without_disguises((curve(0.092), delay), rows(25))) == 2


@pytest.mark.parametrize(("warm_up_c", "stays"), [(0.0, False), (15.0, True)])
def test_a_drift_that_does_not_drift_is_no_second_explanation_beside_a_delay(
    warm_up_c: float, stays: bool
) -> None:
    frame = pd.DataFrame({"true_range_m": 5.0, "time_s": np.linspace(0, 3000, 50)})
    seen = cast(View, SimpleNamespace(recorded=rows(0).recorded, scene=scene(frame)))
    delay = option(AntennaDelay(delay_ns=0.77))
    drift = option(TemperatureDrift(-5.0, 48.0, warm_up_c))
    assert without_disguises((delay, drift), seen) == ((delay, drift) if stays else (delay,))
    assert without_disguises((drift,), seen) == (drift,)
