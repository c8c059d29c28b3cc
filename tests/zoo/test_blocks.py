"""Models that read levels and range: their rows, their floors, and trees against scikit-learn."""

from __future__ import annotations

import io

import numpy as np
import pytest
import torch
from blocks import CIR, made_up_blocks
from sklearn.base import clone
from sklearn.model_selection import GroupKFold, cross_val_score

from zoo import Constant, ConstantByLevel, GradientBoosting
from zoo.inputs import Input, blocks_of, layout
from zoo.modules.blocks import LEVEL_FIGURES, Columns, LevelFigures, StandardiseKnown
from zoo.modules.features import FEATURES, marano_features
from zoo.modules.preparation import apply_in_blocks
from zoo.modules.trees import from_boosting

X, Y, LINKS = made_up_blocks(400, seed=1)
LEVEL_COLUMNS, RANGE_COLUMN = slice(CIR, CIR + 8), slice(CIR + 8, CIR + 9)
FAST = GradientBoosting(trees=60)


def test_rows_are_laid_out_in_one_order() -> None:
    assert blocks_of(("range", "features", "levels")) == ("cir", "levels", "range")
    assert layout(("levels", "range", "cir"), 166) == (
        *(Input("cir", 157), Input("levels", 8)),
        Input("range", 1),
    )
    assert layout(("cir", "levels"), 8) == (Input("levels", 8),)


@pytest.mark.parametrize(("reads", "width"), [(("levels",), 9), (("cir", "levels"), 7)])
def test_rows_that_do_not_fit_are_refused(reads: tuple[str, ...], width: int) -> None:
    with pytest.raises(ValueError, match=f"n_features = {width}: rows need 8 of levels"):
        layout(reads, width)


def test_an_unknown_read_is_refused() -> None:
    with pytest.raises(ValueError, match="colour"):
        blocks_of(("cir", "colour"))


def test_level_figures_are_per_symbol_and_in_decibels() -> None:
    row = torch.tensor([[-80.0, -83.0, 50.0, 100.0, 2000.0, float("nan"), 1000.0, 0.0]])
    figures = dict(zip(LEVEL_FIGURES, LevelFigures()(row)[0].tolist(), strict=True))
    assert figures["rx_less_first_path_db"] == 3
    assert figures["preamble_count"] == 100
    assert figures["noise_std_db"] == pytest.approx(20 * np.log10(0.5), abs=1e-5)
    assert figures["peak_ampl_db"] == pytest.approx(20 * np.log10(20), abs=1e-5)
    assert np.isnan(figures["fp_ampl1_db"])
    assert figures["fp_ampl3_db"] == pytest.approx(-60)


def test_columns_hold_levels_range_features_and_bins() -> None:
    columns = Columns(layout(GradientBoosting.reads, X.shape[1]), cir_samples=10)
    values = apply_in_blocks(columns, X).numpy()
    assert values.shape == (400, columns.width) == (400, len(LEVEL_FIGURES) + 1 + 6 + 10)
    np.testing.assert_array_equal(values[:, len(LEVEL_FIGURES)], X[:, -1])
    np.testing.assert_array_equal(values[:, -10:], X[:, :10])
    features = values[:, -10 - len(FEATURES) : -10]
    np.testing.assert_allclose(features, marano_features(X[:, :CIR]), rtol=2e-5)


def test_unknown_values_become_the_mean_and_far_ones_are_held() -> None:
    scaling = StandardiseKnown(2)
    scaling.fit(torch.tensor([[1.0, float("nan")], [3.0, float("nan")]]))
    rows = torch.tensor([[float("nan"), 5.0], [2.0, float("nan")], [99.0, 0.0]])
    assert scaling(rows).tolist() == [[0, 5], [0, 0], [5, 0]]


def test_trees_are_scikit_learns_trees() -> None:
    machine = FAST._machine()
    values = X[:, :40].copy()
    values[::7, 3] = np.nan
    machine.fit(values, Y)
    trees = from_boosting(machine)
    rows = np.random.default_rng(0).permuted(values, axis=0)
    rows[::5, 7] = np.nan  # never unknown in training
    expected = machine.predict(rows)
    np.testing.assert_allclose(trees(torch.from_numpy(rows)).numpy(), expected, atol=1e-6)
    assert np.ptp(expected) > 0.1


def test_constant_is_the_median_and_needs_no_known_value() -> None:
    model = Constant().fit(np.full((3, 1), np.nan), [0.1, 0.2, 0.9])
    assert model.predict([[np.nan], [4.0]]) == pytest.approx([0.2, 0.2])


def test_constant_by_level_takes_the_median_of_each_fifth() -> None:
    levels, level = X[:, LEVEL_COLUMNS], X[:, CIR]
    model = ConstantByLevel().fit(levels, Y)
    edges = np.quantile(level.astype(float), [0.2, 0.4, 0.6, 0.8])
    piece = np.searchsorted(edges, level)
    expected = np.array([np.median(Y[piece == k]) for k in range(5)])[piece]
    np.testing.assert_allclose(model.predict(levels), expected, atol=1e-6)
    unknown = np.full((1, 8), np.nan)
    assert model.predict(unknown) == pytest.approx(np.median(Y))
    with pytest.raises(ValueError, match="rx_power_dbm is known in no training row"):
        ConstantByLevel().fit(np.full((3, 8), np.nan), np.ones(3))


def test_a_level_that_never_changes_gives_one_constant() -> None:
    model = ConstantByLevel().fit(np.full((4, 8), -80.0), [0.1, 0.2, 0.2, 0.9])
    assert model.predict(np.full((1, 8), -70.0)) == pytest.approx(0.2)


@pytest.mark.parametrize("columns", [slice(None), slice(CIR, None)])
def test_boosting_learns_with_and_without_a_cir(columns: slice) -> None:
    rows = X[:, columns]
    scores = cross_val_score(
        clone(FAST), rows, Y, groups=LINKS, cv=GroupKFold(4), scoring="neg_mean_absolute_error"
    )
    floor = np.abs(Y - np.median(Y)).mean()
    assert -scores.mean() < 0.5 * floor


@pytest.mark.parametrize(
    ("model", "columns"),
    [
        (Constant(), RANGE_COLUMN),
        (ConstantByLevel(), LEVEL_COLUMNS),
        (FAST, slice(None)),
    ],
)
def test_a_fit_travels_as_plain_arrays_and_repeats(model, columns: slice) -> None:
    fitted = clone(model).fit(X[:, columns], Y)
    stored = io.BytesIO()
    np.savez(stored, **fitted.fitted_state())
    stored.seek(0)
    copy = clone(model)
    with np.load(stored, allow_pickle=False) as state:
        assert copy.restore_state(dict(state))
    np.testing.assert_array_equal(copy.predict(X[:, columns]), fitted.predict(X[:, columns]))
    again = clone(model).fit(X[:, columns], Y)
    np.testing.assert_array_equal(again.predict(X[:, columns]), fitted.predict(X[:, columns]))


def test_nan_in_the_cir_and_a_deviation_of_a_model_without_one_are_refused() -> None:
    rows = X[:20].copy()
    fitted = clone(FAST).fit(X, Y)
    with pytest.raises(ValueError, match="gives no standard deviation"):
        fitted.predict(rows, return_std=True)
    rows[3, 7] = np.nan
    with pytest.raises(ValueError, match="X contains NaN in the CIR"):
        fitted.predict(rows)


def test_floors_say_so() -> None:
    assert Constant.floor
    assert ConstantByLevel.floor
    assert not GradientBoosting.floor
