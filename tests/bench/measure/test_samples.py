"""Order statistics of timing samples."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from bench.measure import samples
from bench.measure.samples import median_interval, median_rank


def summarise(batch, rounds_us, share=1.0):
    return samples.summarise(batch, rounds_us, [share] * len(rounds_us))


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


def test_samples_of_one_round_are_not_taken_for_independent() -> None:
    rng = np.random.default_rng(5)
    shared = 100 + rng.normal(0, 3, (20, 1)) + np.zeros((20, 50))
    wide = summarise(1, shared)
    narrow = summarise(1, rng.permutation(shared.ravel()).reshape(20, 50))
    assert wide.high_us - wide.low_us > 2 * (narrow.high_us - narrow.low_us)


@pytest.mark.parametrize(("share", "unstable"), [(0.99, False), (0.5, True)])
def test_a_core_shared_with_others_is_unstable_however_steady_the_samples(share, unstable) -> None:
    assert summarise(1, np.full((20, 5), 100.0), share).unstable is unstable
