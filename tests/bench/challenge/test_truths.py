"""True parameters of effects in other forms: those that come nearest together."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.challenge.truths import true_values
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.fitted.power_curve import PowerCurve
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.ranging.range_scale import RangeScale

LEVELS_DBM = tuple(np.arange(-97.0, -50.0, 3.0).tolist())


@pytest.fixture(scope="module")
def whole() -> View:
    rng = np.random.default_rng(4)
    heading, level = rng.uniform(-180, 180, 600), rng.uniform(-95, -65, 600)
    range_m = rng.uniform(2, 20, 600)
    frame = pd.DataFrame(
        {"link": [f"l{i // 6}" for i in range(600)], "true_range_m": range_m, "error_m": 0.0}
    )
    frame["range_m"], frame["azimuth_deg"], frame["plain_dbm"] = range_m, heading, level
    frame["rx_power_dbm"] = level - 3.0 * np.cos(np.radians(heading))
    return view(frame, link_codes(frame), np.arange(600), Window(), ("error_m",), False)


def _named(effect: Effect, **intervals: tuple[float, float]) -> LeftOut:
    own = {name: float(getattr(effect, name)) for name in intervals}
    known = tuple(ParameterEstimate(n, own[n], *ends, "m") for n, ends in intervals.items())
    return LeftOut(effect, known, Estimate(0, 0, 0), 1.0, Control("", None), ())


def test_effects_that_change_each_other_are_brought_near_together(whole: View) -> None:
    heading = np.radians(whole.frame["azimuth_deg"].to_numpy())
    by_level = -0.01 * (whole.frame["plain_dbm"].to_numpy() + 80)  # before the gain of the pattern
    by_heading = 0.05 * np.cos(heading)
    curve = PowerCurve(LEVELS_DBM, (0.0,) * len(LEVELS_DBM), spread_db=15.0)
    pattern = _named(AntennaPattern(delay_m=0.04), delay_m=(0.03, 0.05))
    shifts = [by_level, by_heading]
    _, beside = true_values(whole, [_named(curve), pattern], shifts)
    (alone,) = true_values(whole, [pattern], [by_heading])
    assert alone["delay_m"] == pytest.approx(0.05, abs=1e-3)
    assert beside["delay_m"] == pytest.approx(0.05 - 0.03, abs=1e-2)


def test_what_leaves_ranges_as_they_are_has_no_truth_in_them(whole: View) -> None:
    heading = np.radians(whole.frame["azimuth_deg"].to_numpy())
    effect = AntennaPattern(delay_m=0.05, gain_db=2.0)
    named = _named(effect, delay_m=(0.04, 0.06), gain_db=(1.5, 2.5))
    (found,) = true_values(whole, [named], [0.05 * np.cos(heading)])
    assert set(found) == {"delay_m"}


def test_forms_that_fit_exactly_are_as_true_beside_others(whole: View) -> None:
    range_m = whole.scene.true_range_m
    heading = np.radians(whole.frame["azimuth_deg"].to_numpy())
    scale = _named(RangeScale(scale=0.004), scale=(0.003, 0.005))
    pattern = _named(AntennaPattern(delay_m=0.04), delay_m=(0.03, 0.05))
    shifts = [0.005 * range_m, 0.05 * np.cos(heading)]
    of_scale, of_pattern = true_values(whole, [scale, pattern], shifts)
    assert of_scale["scale"] == pytest.approx(0.005, abs=1e-6)
    assert of_pattern["delay_m"] == pytest.approx(0.05, abs=1e-5)
