"""Accuracy figures against scikit-learn and scipy, and intervals that respect links."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from sklearn.metrics import mean_absolute_error, r2_score

from bench.errors import BenchError
from bench.measure.metrics import over_seeds, score
from bench.results import Interval


def _clustered(links: int, rows: int, seed: int, spread_m: float = 0.3):
    """Return errors, predictions and links whose residual is mostly the link's own."""
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(links), rows)
    own = spread_m * rng.normal(size=links)[link]
    errors = own + 0.05 * rng.normal(size=links * rows)
    return errors, 0.5 * own, link


def test_figures_are_those_of_scikit_learn_and_numpy() -> None:
    errors, predicted, link = _clustered(40, 25, seed=1)
    found = score(errors, predicted, link)
    assert found.mae_m.value == pytest.approx(mean_absolute_error(errors, predicted))
    assert found.r2.value == pytest.approx(r2_score(errors, predicted))
    assert found.sigma_m.value == pytest.approx(np.std(errors - predicted))
    assert found.bias_m == pytest.approx(np.mean(errors - predicted))
    assert found.raw_mae_m == pytest.approx(np.abs(errors).mean())
    assert found.raw_sigma_m == pytest.approx(errors.std())
    assert (found.rows, found.links) == (1000, 40)


def test_sign_error_is_measured_minus_true_and_correction_subtracts() -> None:
    found = score([0.3, 0.5], [0.1, 0.1], ["a", "b"])
    assert found.bias_m == pytest.approx(0.3)


def test_a_common_offset_of_a_kilometre_costs_no_digits() -> None:
    errors, predicted, link = _clustered(30, 10, seed=2)
    near = score(errors, predicted, link)
    far = score(errors + 1e3, predicted, link)
    assert far.sigma_m.value == pytest.approx(near.sigma_m.value, rel=1e-9)
    assert far.sigma_m.low == pytest.approx(near.sigma_m.low, rel=1e-6)


def test_intervals_agree_with_scipy_bca_over_link_means() -> None:
    # Equal rows per link: the mean error over rows is the mean over links, which scipy can do.
    errors, predicted, link = _clustered(40, 25, seed=3)
    per_link = np.abs(errors - predicted).reshape(40, 25).mean(axis=1)
    theirs = stats.bootstrap(
        (per_link,), np.mean, n_resamples=20_000, method="BCa", rng=np.random.default_rng(0)
    ).confidence_interval
    ours = score(errors, predicted, link, resamples=20_000).mae_m
    assert ours.low == pytest.approx(theirs.low, rel=0.02)
    assert ours.high == pytest.approx(theirs.high, rel=0.02)


@pytest.mark.parametrize("figure", ["sigma_m", "r2"])
def test_skewed_figures_have_the_bca_interval_of_scipy(figure) -> None:
    # One row per link, few links: sigma and R2 are biased, so every term of the interval counts.
    # The errors share an offset: the scatter of a resample is about the mean of that resample.
    rng = np.random.default_rng(7)
    errors = 0.5 + rng.gamma(1.0, 0.2, 15)
    predicted = 0.5 + 0.7 * (errors - 0.5) + rng.normal(0, 0.1, 15)
    of = {"sigma_m": lambda e, p, axis=-1: np.std(e - p, axis=axis), "r2": _r2}[figure]
    theirs = stats.bootstrap(
        (errors, predicted),
        of,
        n_resamples=50_000,
        method="BCa",
        paired=True,
        rng=np.random.default_rng(0),
    ).confidence_interval
    ours = getattr(score(errors, predicted, np.arange(15), resamples=50_000), figure)
    width = theirs.high - theirs.low
    assert ours.low == pytest.approx(theirs.low, abs=0.02 * width)
    assert ours.high == pytest.approx(theirs.high, abs=0.02 * width)


def _r2(errors, predicted, axis=-1):
    left = ((errors - predicted) ** 2).sum(axis=axis)
    return 1 - left / (errors.var(axis=axis) * errors.shape[axis])


def test_links_not_rows_are_the_unit_of_uncertainty() -> None:
    errors, predicted, link = _clustered(30, 200, seed=4)
    by_link = score(errors, predicted, link).mae_m
    by_row = score(errors, predicted, np.arange(len(errors))).mae_m
    assert by_link.high - by_link.low > 5 * (by_row.high - by_row.low)


def test_intervals_cover_the_truth_as_often_as_they_say() -> None:
    truth = score(*_clustered(20_000, 20, seed=5), resamples=2).mae_m.value
    hits = 0
    for seed in range(200):
        found = score(*_clustered(40, 20, seed=100 + seed), seed=seed, resamples=500).mae_m
        hits += found.low <= truth <= found.high
    assert 0.88 <= hits / 200 <= 0.99


def test_resampling_in_blocks_changes_nothing_but_memory(monkeypatch) -> None:
    sample = _clustered(50, 4, seed=6)
    whole = score(*sample, seed=3)
    monkeypatch.setattr("bench.measure.metrics._BLOCK_CELLS", 50 * 7)
    assert score(*sample, seed=3) == whole
    assert score(*sample, seed=4) != whole


def test_one_link_has_no_interval() -> None:
    found = score([0.1, 0.2, 0.4], [0.1, 0.1, 0.1], ["a", "a", "a"])
    assert (found.mae_m.low, found.mae_m.high, found.links) == (None, None, 1)


def test_two_links_have_an_interval_and_2000_resamples_are_drawn() -> None:
    sample = ([0.1, 0.2, 0.4, 0.3], [0.1, 0.1, 0.1, 0.1], ["a", "a", "b", "b"])
    found = score(*sample)
    assert found.mae_m.low < found.mae_m.value < found.mae_m.high
    assert found == score(*sample, resamples=2000)
    assert score(*_clustered(9, 3, 1)) != score(*_clustered(9, 3, 1), resamples=2001)


def test_rows_without_a_link_are_a_link_of_their_own() -> None:
    found = score([0.1, 0.2, 0.3], [0.0, 0.0, 0.0], np.array(["a", None, None], object))
    assert (found.links, found.rows) == (2, 3)


def test_constant_errors_that_rounding_scatters_are_constant() -> None:
    wide = next(np.full(n, v) for n in range(3, 60) for v in (1000.1, 0.1, 33.3)
                if np.full(n, v).mean() != v)  # fmt: skip
    found = score(wide, np.zeros(len(wide)), np.arange(len(wide)))
    assert found.r2.value == 0.0


def test_resamples_of_links_with_constant_errors_are_constant_too() -> None:
    # A resample that holds one link alone has no scatter but that of rounding: its R2 is 0.
    for high in (0.41, 0.7, 1.3, 3.7):
        errors = np.repeat([0.1, high, 0.1], 7)
        found = score(errors, np.zeros(21), np.repeat([0, 1, 2], 7))
        assert found.r2.low > -100


@pytest.mark.parametrize(("predicted", "r2"), [([0.25, 0.25, 0.25], 1.0), ([0.1, 0.25, 0.25], 0.0)])
def test_r2_of_constant_errors_follows_scikit_learn(predicted, r2) -> None:
    found = score([0.25, 0.25, 0.25], predicted, ["a", "b", "c"])
    assert found.r2.value == r2 == r2_score([0.25, 0.25, 0.25], predicted)
    assert np.isfinite([found.r2.low, found.r2.high, found.sigma_m.low]).all()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (([], [], []), "no rows"),
        (([0.1], [0.1, 0.2], ["a"]), "one prediction per error"),
        (([0.1, 0.2], [0.1, np.nan], ["a", "b"]), "1 of 2 predictions are not finite"),
        (([np.inf, 0.2], [0.1, 0.1], ["a", "b"]), "1 of 2 errors are not finite"),
        (([0.1, 0.2], [0.1, 0.1], ["a"]), "1 links for 2 errors"),
    ],
)
def test_bad_input_is_one_clear_line(arguments, said) -> None:
    with pytest.raises(BenchError, match=said):
        score(*arguments)


def test_over_seeds_is_students_interval_of_the_mean() -> None:
    values = [0.10, 0.12, 0.11, 0.13]
    expected = stats.ttest_1samp(values, 0).confidence_interval(0.95)
    found = over_seeds(values)
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high))
    assert found.value == pytest.approx(0.115)


def test_over_seeds_keeps_the_links_uncertainty_however_many_seeds() -> None:
    many = [Interval(0.1 + 1e-6 * k, 0.08 + 1e-6 * k, 0.15 + 1e-6 * k) for k in range(50)]
    found = over_seeds(many)
    assert (found.value - found.low, found.high - found.value) == pytest.approx(
        (0.02, 0.05), rel=1e-3
    )


def test_over_seeds_of_one_and_of_none() -> None:
    assert over_seeds([Interval(0.1, 0.05, 0.2)]) == Interval(0.1, 0.05, 0.2)
    assert over_seeds([0.1]) == Interval(0.1)
    with pytest.raises(BenchError, match="no seeds"):
        over_seeds([])
