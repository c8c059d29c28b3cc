"""What a receiver's way of rounding takes a constant for: intervals hold beside every way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select import as_likely, marks
from bench.discrepancy.select.settings import FORM_LEAD_NATS
from bench.discrepancy.select.verdict import LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_rounding import RangeRounding

Values = tuple[ParameterEstimate, ...]
GRID = RangeRounding(0.1)


def _by_lean(_c: object, _v: object, others: tuple[Effect, ...], effect: Effect) -> Values:
    """Return a delay that takes half a step for each half that the grid leans, +-0.1 ns."""
    if isinstance(effect, RangeRounding):
        return (ParameterEstimate("step_m", 0.1, 0.1, 0.1, "m"),)
    lean = sum(one.lean for one in others if isinstance(one, RangeRounding))
    return (ParameterEstimate("delay_ns", 1 - lean, 0.9 - lean, 1.1 - lean, "ns"),)


@pytest.fixture(autouse=True)
def _no_fit(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    if "whole" not in request.node.name:
        monkeypatch.setattr(as_likely, "once_more", lambda _c, _v, _a, effect: effect)


def _over(grid: RangeRounding, effect: Effect) -> list[ParameterEstimate]:
    return list(as_likely.over_forms(_by_lean, None, None, (grid,), effect))  # type: ignore[arg-type]


def test_an_interval_spans_those_of_every_way_that_is_not_told() -> None:
    (alone,) = _over(GRID, AntennaDelay())
    assert (alone.low, alone.high) == pytest.approx((0.9, 1.1))
    (made,) = _over(replace(GRID, untold=(-0.5, 0.5)), AntennaDelay())
    assert (made.value, made.low, made.high) == pytest.approx((1, 0.4, 1.6))


def test_the_way_itself_is_said_to_be_open() -> None:
    (step,) = _over(GRID, GRID)
    assert step.determined
    _, lean = _over(GRID, replace(GRID, untold=(-0.5,)))
    assert (lean.name, lean.determined, lean.low, lean.high) == ("lean", False, -0.5, 0)


def test_ways_that_ranges_speak_for_as_much_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    worth = {0.0: 10.0, -0.5: 10.0 - 0.9 * FORM_LEAD_NATS, 0.5: 10.0 - 2 * FORM_LEAD_NATS}
    monkeypatch.setattr(marks, "worth_beside", lambda _, forms: worth[forms[0].lean])
    assert marks.likeliest(None, GRID) == replace(GRID, untold=(-0.5,))  # type: ignore[arg-type]
    worth[0.5] = 10 + 2 * FORM_LEAD_NATS
    assert marks.likeliest(None, GRID) == replace(GRID, lean=0.5)  # type: ignore[arg-type]


def _table(seed: int, cut_m: float = 0.0) -> pd.DataFrame:
    """Return ranges of 48 links; with `cut_m` they drift and are cut down to steps. SIMULATED."""
    rng, link = np.random.default_rng(seed), np.repeat(np.arange(48), 8)
    true, warm = rng.uniform(3, 25, 48)[link], rng.uniform(10, 40, 48)[link]
    warm = warm + rng.uniform(-4, 4, len(link))
    range_m = true + 0.02 * rng.normal(size=len(link))
    if cut_m:
        range_m = cut_m * np.floor((range_m + 0.006 * (warm - 25)) / cut_m)
    named = {"link": [f"l{i}" for i in link], "true_range_m": true, "temperature_c": warm}
    return pd.DataFrame({**named, "range_m": range_m})


def test_a_whole_drift_beside_steps_that_are_cut_down() -> None:
    found = bench.diagnose(_table(1, 0.12), _table(2))
    named = {v.names[0]: v for v in found.selection.verdicts if isinstance(v, LeftOut)}
    assert set(named) == {"range-rounding", "temperature-drift"}
    told = {one.name: one for one in named["temperature-drift"].parameters}
    reference = told["reference_c"]
    assert reference.low <= 25 <= reference.high
    assert reference.high - reference.low > 0.9 * 0.12 / 0.006 / 2  # half a step, either side
    lean = [one for one in named["range-rounding"].parameters if one.name == "lean"]
    assert lean
    assert not lean[0].determined
