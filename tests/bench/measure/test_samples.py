"""Order statistics of timing samples."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy import stats

from bench.measure import samples
from bench.measure.samples import (
    Round,
    median_interval,
    median_rank,
    reference_level,
    undisturbed,
)


def summarise(batch, rounds_us, reference_us=10.0):
    rounds = [Round(list(some), (reference_us, reference_us)) for some in rounds_us]
    return samples.summarise(batch, rounds)


@pytest.mark.parametrize("count", [6, 7, 10, 20, 51, 200])
def test_rank_is_the_tightest_that_covers_95_percent(count) -> None:
    rank = median_rank(count)
    covers = 1 - 2 * stats.binom.cdf(rank - 1, count, 0.5)
    tighter = 1 - 2 * stats.binom.cdf(rank, count, 0.5)
    assert covers >= 0.95 > tighter


def test_interval_covers_the_median_of_a_skewed_distribution() -> None:
    rng = np.random.default_rng(1)
    draws = rng.exponential(size=(2000, 20))
    intervals = np.array([median_interval(row) for row in draws])
    inside = (intervals[:, 0] <= np.log(2)) & (np.log(2) <= intervals[:, 1])
    assert inside.mean() >= 0.94


def test_figures_are_those_of_numpy_over_all_samples() -> None:
    rounds = np.random.default_rng(2).gamma(50, 2, (20, 5))
    found = summarise(4, rounds)
    assert found.batch == 4
    assert found.median_us == pytest.approx(np.median(rounds))
    assert found.p95_us == pytest.approx(np.percentile(rounds, 95))
    assert found.p99_us == pytest.approx(np.percentile(rounds, 99))
    assert found.samples_us == pytest.approx(rounds.ravel(), abs=1e-3)


def test_quiet_samples_are_stable() -> None:
    rounds = 100 + np.random.default_rng(3).normal(0, 2, (20, 5))
    assert not summarise(1, rounds).unstable


def test_a_lone_outlier_does_not_make_samples_unstable_but_shows_in_p99() -> None:
    rounds = 100 + np.random.default_rng(4).normal(0, 1, (20, 5))
    rounds[7, 2] = 5000
    found = summarise(1, rounds)
    assert not found.unstable
    assert found.p99_us > 120


def test_drift_is_unstable() -> None:
    rounds = np.linspace(100, 115, 20)[:, None] + np.zeros((20, 5))
    assert summarise(1, rounds).unstable


def test_two_speeds_are_unstable() -> None:
    rounds = np.where(np.arange(20)[:, None] % 2, 100.0, 130.0) + np.zeros((20, 5))
    found = summarise(1, rounds)
    assert found.unstable
    assert (found.low_us, found.high_us) == (100, 130)


def test_a_figure_that_most_rounds_share_is_unstable_where_some_were_much_quicker() -> None:
    found = summarise(1, np.repeat([4.2, 2.7], [12, 2])[:, None] + np.zeros((14, 3)))
    assert found.high_us - found.low_us < 0.1 * found.median_us
    assert found.unstable


def test_samples_of_one_round_are_not_taken_for_independent() -> None:
    rng = np.random.default_rng(5)
    shared = 100 + rng.normal(0, 3, (20, 1)) + np.zeros((20, 50))
    wide = summarise(1, shared)
    narrow = summarise(1, rng.permutation(shared.ravel()).reshape(20, 50))
    assert wide.high_us - wide.low_us > 2 * (narrow.high_us - narrow.low_us)


def quiet(count: int = 8, **changes: object) -> list[Round]:
    """Return undisturbed rounds, the last one changed."""
    plain = Round([100.0] * 5, (10.0, 10.1), 0.999, -0.2)
    return [plain] * (count - 1) + [dataclasses.replace(plain, **changes)]


@pytest.mark.parametrize(
    ("changes", "kept"),
    [
        ({}, 8),
        ({"core_share": 0.96}, 7),
        ({"core_share": 0.98}, 8),
        ({"reference_us": (10.0, 10.6), "samples_us": [111.0] * 5}, 7),
        ({"reference_us": (10.6, 10.0), "samples_us": [111.0] * 5}, 7),
        ({"reference_us": (10.4, 10.4), "samples_us": [111.0] * 5}, 8),  # as it wanders
        ({"reference_us": (15.0, 15.0)}, 8),  # the figure did not notice
        ({"reference_us": (15.0, 15.0), "samples_us": [109.0] * 5}, 8),
        ({"others": 0.01}, 7),
        ({"others": 0.0}, 8),
        ({"samples_us": [900.0] * 5}, 8),  # a slow model is no disturbance
    ],
)
def test_rounds_that_others_disturbed_are_dropped(changes, kept) -> None:
    assert len(undisturbed(quiet(**changes), level_us=10.0)) == kept


def test_the_reference_level_is_the_lower_quartile_of_all_loops() -> None:
    rounds = [Round([1.0], (10.0 + k, 30.0)) for k in range(20)]
    assert reference_level(rounds) == pytest.approx(np.percentile([*range(10, 30), *[30] * 20], 25))


def test_the_ratio_to_the_reference_is_that_of_the_same_round() -> None:
    # The machine slows down to half its speed in the middle: the ratio does not notice.
    slow = np.repeat([1.0, 2.0], 10)
    rounds = [Round([50.0 * k] * 5, (9.0 * k, 11.0 * k)) for k in slow]
    found = samples.summarise(1, rounds)
    assert found.reference_ratio == pytest.approx(5.0)
    assert found.unstable


def test_what_is_kept_of_a_machine_that_wanders_has_the_median_of_all() -> None:
    rng = np.random.default_rng(6)
    speed = rng.lognormal(0, 0.04, 4000)
    rounds = [
        Round(list(100 * one * rng.lognormal(0, 0.02, 3)), (10 * one, 10 * one)) for one in speed
    ]
    kept = undisturbed(rounds, reference_level(rounds))
    assert len(kept) > 0.9 * len(rounds)
    middle = np.median([one.figure_us for one in kept])
    assert middle == pytest.approx(np.median([one.figure_us for one in rounds]), rel=0.01)


def test_a_neighbour_that_comes_and_goes_is_left_out_of_the_figure() -> None:
    slow = np.where(np.arange(30) % 3 == 0, 1.4, 1.0)
    rounds = [Round([100.0 * k] * 3, (10.0 * k, 10.0 * k)) for k in slow]
    kept = undisturbed(rounds, reference_level(rounds))
    assert [one.figure_us for one in kept] == [100.0] * 20
