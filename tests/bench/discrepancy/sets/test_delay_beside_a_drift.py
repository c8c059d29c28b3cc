"""A constant beyond what temperature may do is an antenna delay's, beside a drift of any sign."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.skill import tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.search import Fitted, Objective, plainer
from bench.physics.effects.ranging.temperature import TemperatureDrift
from tests.bench.discrepancy.sets.test_same_rows import names_of, rows_of


@pytest.mark.parametrize("slope_mm_per_c", [-4.0, 4.0])
def test_a_delay_is_not_swallowed_by_a_drift(slope_mm_per_c: float) -> None:
    frame = rows_of(3)
    warm = np.random.default_rng(3).uniform(5, 35, len(frame))
    shift_m = 0.25 + slope_mm_per_c / 1e3 * (warm - 25)
    both = {"antenna-delay", "temperature-drift"}
    assert names_of(frame.assign(temperature_c=warm), shift_m) == both


def test_a_warm_up_that_gains_nothing_is_taken_back() -> None:
    rng, frame = np.random.default_rng(5), rows_of(5)
    frame = frame.assign(temperature_c=rng.uniform(5, 35, len(frame)))
    frame = frame.assign(time_s=np.arange(len(frame)) * 20.0)
    drift, noise = -2e-3 * (frame["temperature_c"] - 25), rng.normal(0, 0.02, (2, len(frame)))
    far = frame["true_range_m"]
    recorded = frame.assign(range_m=far + drift + noise[0], error_m=drift + noise[0])
    simulated = frame.assign(range_m=far + noise[1], error_m=noise[1])
    rows = view(recorded, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    comparison = TableComparison(simulated, Window())
    base = tally(comparison.ensemble(rows, (), 1))
    objective = Objective(TemperatureDrift, comparison, rows, (), base)
    bent = TemperatureDrift(slope_mm_per_c=-2.0, warm_up_c=4.0, reference_c=29.0)
    start = Fitted(bent, objective(vars(bent)), 1)
    made = plainer(objective, start, 3.0 / len(frame)).effect
    assert made.warm_up_c == 0
    assert made.slope_mm_per_c == pytest.approx(-2.0, abs=1.0)
