"""Rounded samples repeat each other; others never do."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.joint.polish import shares, with_shares
from bench.discrepancy.joint.sizes import estimates
from bench.discrepancy.select.candidates import offered
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.quantisation import (
    OnGrid,
    Quantisation,
    equal_share,
    grid_step,
    late_alone,
    on_grid,
)


def _table(
    step: float, magnitudes: bool, beside: bool = False, noise: float = 40.0
) -> pd.DataFrame:
    rng = np.random.default_rng(3)
    cirs = noise * (rng.normal(size=(30, 150)) + 1j * rng.normal(size=(30, 150)))
    if step and beside:
        cirs = step * (np.floor(cirs.real / step) + 0.5 + 1j * (np.floor(cirs.imag / step) + 0.5))
    elif step:
        cirs = step * (np.rint(cirs.real / step) + 1j * np.rint(cirs.imag / step))
    kept = np.abs(cirs).astype(np.float32) if magnitudes else cirs.astype(np.complex64)
    return pd.DataFrame({"cir": list(kept)})


def test_rounded_samples_repeat_each_other_in_parts_and_in_magnitudes() -> None:
    for magnitudes in (False, True):
        assert equal_share(_table(0, magnitudes)["cir"]) < 0.001
        assert equal_share(_table(20, magnitudes)["cir"]) > 0.3


def test_quantisation_is_offered_only_where_some_samples_are_equal() -> None:
    kinds = {"quantisation": Quantisation, "noise-floor": NoiseFloor}
    able, lacking = offered(kinds, _table(1, False), True)
    assert set(able) == set(kinds)
    able, lacking = offered(kinds, _table(0, False), True)
    assert set(able) == {"noise-floor"}
    assert "some are equal" in lacking["quantisation"]


def test_the_step_is_the_grids() -> None:
    for magnitudes in (False, True):
        assert abs(grid_step(_table(20, magnitudes)["cir"]) - 20) < 0.1
        forms = Quantisation.by_mark(_table(20, magnitudes))
        assert [vars(form)["step_counts"] for form in forms] == pytest.approx([20] * 4, abs=0.1)
        assert Quantisation.by_mark(_table(1, magnitudes)) == ()


def test_the_step_of_a_grid_is_read_off_and_fitted_only_where_steps_grow() -> None:
    for beside in (False, True):
        for magnitudes in (False, True):
            cirs = _table(20, magnitudes, beside)["cir"]
            assert on_grid(cirs, grid_step(cirs))
            forms = Quantisation.by_mark(pd.DataFrame({"cir": cirs}))
            assert all(isinstance(form, OnGrid) and form.name == "quantisation" for form in forms)
            names = {item.name for form in forms for item in free_parameters(type(form))}
            assert "step_counts" not in names
            assert "offset_counts" in names
    cirs = _table(0, True)["cir"].map(lambda row: np.float32(10) * np.round(np.sqrt(row)) ** 2)
    assert not on_grid(cirs, grid_step(cirs))
    assert not on_grid(cirs, 0.0)


def test_a_step_that_was_read_off_is_said_without_doubt() -> None:
    for form, known in ((OnGrid(32.0, 90.0), True), (Quantisation(32.0, 90.0), False)):
        reach = np.full((2, len(free_parameters(type(form)))), 0.1)
        (step,) = [one for one in estimates(form, reach) if one.name == "step_counts"]
        assert step.value == pytest.approx(32.0)
        assert (step.low == step.high) is known


def test_a_grid_is_coarse_by_its_step_over_the_noise_though_loud_samples_differ() -> None:
    tail = 8 * np.sqrt(1e4 + np.arange(60))  # of signals, on the same grid
    for noise, coarse in ((40.0, True), (90.0, False)):
        table = _table(8, True, noise=noise)
        table["cir"] = table["cir"].map(lambda row: np.append(row, tail))
        assert equal_share(table["cir"]) < 0.5
        assert bool(Quantisation.by_mark(table)) is coarse


@pytest.mark.parametrize("magnitudes", [False, True])
def test_a_coarse_step_is_the_grids_too(magnitudes: bool) -> None:
    forms = Quantisation.by_mark(_table(530, magnitudes, noise=150.0))
    assert [vars(form)["step_counts"] for form in forms] == pytest.approx([530] * 4, abs=0.5)


@pytest.mark.parametrize("magnitudes", [False, True])
@pytest.mark.parametrize("step", [20.0, 90.0])
def test_a_grid_without_zero_is_seen(step: float, magnitudes: bool) -> None:
    assert not any(
        vars(one)["beside_zero"] for one in Quantisation.by_mark(_table(step, magnitudes))
    )
    forms = Quantisation.by_mark(_table(step, magnitudes, beside=True))
    assert [vars(one)["beside_zero"] for one in forms] == [1.0] * 2
    assert [vars(one)["step_counts"] for one in forms] == pytest.approx([step] * 2, abs=0.1)


def test_a_fit_keeps_what_is_not_fitted() -> None:
    effect = Quantisation(step_counts=90.0, beside_zero=1.0)
    assert with_shares((effect,), shares((effect,))) == (effect,)


def test_steps_that_grow_with_what_they_stand_for_have_their_zero() -> None:
    """Squares of their magnitudes are no multiples of one step, and lie anywhere between."""
    rng, step = np.random.default_rng(5), 200.0
    codes = np.rint(rng.normal(size=(2, 30, 150)) * rng.exponential(1.5, size=(30, 150)))
    parts = step * np.sinh(0.12 * codes) / 0.12
    table = pd.DataFrame({"cir": list(np.hypot(*parts).astype(np.float32))})
    forms = Quantisation.by_mark(table)
    assert [vars(one)["beside_zero"] for one in forms] == [0.0] * 4
    finest = step * np.sinh(0.12) / 0.12
    assert [vars(one)["step_counts"] for one in forms] == pytest.approx([finest] * 4, rel=0.02)


def test_samples_that_are_equal_behind_first_paths_alone_are_not_rounded() -> None:
    """Such as those of which exponents are kept without mantissas: noise ahead has its own."""
    table = _table(0, True)
    table["first_path_index"] = 50.0
    late = np.arange(150) > 58
    powers = [np.where(late, 3.0 ** np.floor(np.log(row) / np.log(3)), row) for row in table["cir"]]
    odd = table.assign(cir=powers)
    assert late_alone(odd)
    assert Quantisation.by_mark(odd) == ()
    assert "before first paths" in Quantisation.unmarked(odd)
    rounded = _table(60, True).assign(first_path_index=50.0)
    assert not late_alone(rounded)
    assert Quantisation.by_mark(rounded)
    unknown = odd.drop(columns="first_path_index")
    assert not late_alone(unknown)
