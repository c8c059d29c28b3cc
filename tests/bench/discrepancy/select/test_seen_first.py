"""Ranges that lie on a grid: seen before any other cause, and taken for scatter by fits."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.per_device import latent_effects
from bench.discrepancy.law.material import material
from bench.discrepancy.law.rounding import roundings
from bench.discrepancy.select import marks
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.simulator import Simulator

WORLD = Resimulation(Simulator(Base(), (TimestampJitter(jitter_samples=0.08),), 3), Window())
STEP_M = 0.2


def _view(shift_m: float = 0.0, step_m: float = STEP_M) -> View:
    rng = np.random.default_rng(2)
    true = rng.uniform(2, 20, 300)
    range_m = true + 0.024 * rng.normal(size=300) + shift_m
    range_m = np.rint(range_m / step_m) * step_m if step_m else range_m
    frame = pd.DataFrame(
        {
            "link": np.repeat([f"l{i}" for i in range(30)], 10),
            "true_range_m": true,
            "range_m": range_m,
            "error_m": range_m - true,
        }
    )
    rows = np.arange(len(frame))
    return view(frame, link_codes(frame), rows, Window(), ("error_m",), False)


def _search(rows: View) -> Search:
    return Search(WORLD, rows, rows, {"range-rounding": RangeRounding}, 0, work=rows)


def test_a_grid_of_ranges_is_seen_and_only_where_there_is_one() -> None:
    (seen,) = marks.marked(_search(_view()))
    assert isinstance(seen, RangeRounding)
    assert seen.step_m == pytest.approx(STEP_M, rel=1e-6)
    assert marks.marked(_search(_view(step_m=0.0))) == ()


def test_centimetres_that_are_printed_are_no_cause() -> None:
    assert marks.marked(_search(_view(step_m=0.01))) == ()


def test_what_other_causes_make_rows_of_a_link_differ_by_hides_no_grid() -> None:
    rows = _view(step_m=0.0)
    grown = 1.02 * rows.frame["range_m"]
    written = np.rint(grown / 0.03) * 0.03
    frame = rows.frame.assign(range_m=written, error_m=written - rows.frame["true_range_m"])
    rows = view(frame, rows.links, rows.rows, Window(), ("error_m",), False)
    assert marks.marked(_search(rows)) == ()
    (seen,) = marks.marked(_search(rows), (RangeScale(0.02),))
    assert isinstance(seen, RangeRounding)


def test_half_a_step_is_a_lean_and_any_other_constant_is_none() -> None:
    for shift_m, lean in ((0.0, 0.0), (-STEP_M / 2, -0.5), (0.3 * STEP_M, 0.0)):
        (seen,) = marks.marked(_search(_view(shift_m)))
        assert isinstance(seen, RangeRounding)
        assert seen.lean == lean


def test_a_shift_beside_a_grid_is_found_in_full() -> None:
    rows, grid = _view(0.03), RangeRounding(STEP_M)
    made = residual_range(WORLD, rows, (grid,), 4)
    assert made is not None
    assert np.mean(made[1]) == pytest.approx(0.03, abs=0.012)
    assert np.std(made[1]) == pytest.approx(STEP_M / np.sqrt(12), rel=0.2)


def test_devices_that_cut_down_are_not_late() -> None:
    rows = _view()
    cut = np.arange(300) // 10 < 12
    frame = rows.frame.assign(tx=np.where(cut, "old", "new"))
    rows = view(frame, rows.links, rows.rows, Window(), ("error_m",), False)
    grid = RangeRounding(STEP_M, of="tx", devices=("old", "new"), leans=(-0.5, 0.0))
    plain, own = (residual_range(WORLD, rows, (one,), 4) for one in (RangeRounding(STEP_M), grid))
    assert plain is not None
    assert own is not None
    moved = own[1] - plain[1]
    assert moved[cut].mean() - moved[~cut].mean() == pytest.approx(STEP_M / 2)


def test_leans_of_devices_must_lead_by_what_their_choice_costs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grid = RangeRounding(STEP_M, of="tx", devices=("a", "b"), leans=(-0.5, 0.0))
    for lead, own in ((grid.chosen_nats + 4, True), (grid.chosen_nats + 2, False)):
        worth = {grid: lead}
        monkeypatch.setattr(marks, "worth_beside", lambda _, some, w=worth: w.get(some[0], 0.0))
        assert (marks.likeliest(_search(_view()), grid) == grid) == own


def test_no_law_says_again_that_ranges_are_rounded() -> None:
    rows = _view()
    made = residual_range(WORLD, rows, (), 4)
    assert made is not None
    given = material(rows.frame, made[1], rows.links)
    assert list(roundings(given))
    assert not list(roundings(SimpleNamespace(rounded=True)))  # type: ignore[arg-type]


def test_only_the_asked_physics_is_fitted() -> None:
    rows = _view(0.03)
    assert latent_effects(WORLD, rows, (), "antenna-pattern") == []
    assert latent_effects(WORLD, rows, (), "ground-bounce") == []


def test_steps_in_which_no_number_is_printed_matter_sooner() -> None:
    """A centimetre may be how numbers are written, half an inch is not."""
    for step_m, seen in ((0.01, ()), (0.0127, ("range-rounding",))):
        assert tuple(one.name for one in marks.marked(_search(_view(step_m=step_m)))) == seen
