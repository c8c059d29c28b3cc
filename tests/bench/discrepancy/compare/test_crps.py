"""Scores against their definitions, written out as loops, and against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from bench.discrepancy.compare.crps import (
    Estimate,
    cluster_bootstrap,
    cluster_quantile,
    crps,
    energy_score,
)
from bench.discrepancy.settings import QUANTILE_DRAWS

RNG = np.random.default_rng(0)


def test_crps_is_the_fair_score_by_its_definition() -> None:
    members, recorded = RNG.normal(size=(5, 7)), RNG.normal(size=7)
    for i in range(7):
        x, y = members[:, i], recorded[i]
        apart = [abs(a - b) for j, a in enumerate(x) for k, b in enumerate(x) if j != k]
        expected = np.mean(np.abs(x - y)) - np.mean(apart) / 2
        assert crps(members, recorded)[i] == pytest.approx(expected)


def test_crps_of_many_members_is_that_of_their_distribution() -> None:
    # Gneiting and Raftery 2007: for N(0, 1) it is y (2 Phi(y) - 1) + 2 phi(y) - 1 / sqrt(pi).
    y = np.array([-1.3, 0.0, 2.0])
    members = stats.norm.ppf((np.arange(4000) + 0.5) / 4000)[:, None] + np.zeros(3)
    exact = y * (2 * stats.norm.cdf(y) - 1) + 2 * stats.norm.pdf(y) - 1 / np.sqrt(np.pi)
    assert crps(members, y) == pytest.approx(exact, abs=1e-3)


def test_crps_of_more_dimensions_and_of_gaps() -> None:
    members, recorded = RNG.normal(size=(3, 4, 2)), RNG.normal(size=(4, 2))
    members[1, 2, 0] = np.nan
    found = crps(members, recorded)
    assert np.isnan(found).tolist() == [[False] * 2, [False] * 2, [True, False], [False] * 2]
    assert found[3, 1] == pytest.approx(crps(members[:, 3:, 1], recorded[3:, 1])[0])


def test_two_members_are_enough_and_one_is_not() -> None:
    assert crps(np.array([[0.0], [2.0]]), np.array([1.0]))[0] == pytest.approx(0.0)
    with pytest.raises(ValueError, match="at least two"):
        crps(np.zeros((1, 3)), np.zeros(3))


def test_energy_score_in_one_dimension_is_crps_and_in_two_its_definition() -> None:
    members, recorded = RNG.normal(size=(6, 9, 1)), RNG.normal(size=(9, 1))
    assert energy_score(members, recorded) == pytest.approx(crps(members, recorded)[:, 0])
    x, y = RNG.normal(size=(4, 1, 2)), RNG.normal(size=(1, 2))
    pairs = [np.linalg.norm(x[i, 0] - x[k, 0]) for i in range(4) for k in range(4) if i != k]
    expected = np.mean([np.linalg.norm(m[0] - y[0]) for m in x]) - np.mean(pairs) / 2
    assert energy_score(x, y)[0] == pytest.approx(expected)


def _clustered(links: int = 40, rows: int = 9) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    link = np.repeat(np.arange(links), rows)
    return rng.gamma(1.0, 1.0, links)[link] + 0.1 * rng.normal(size=len(link)), link


def test_the_bootstrap_resamples_links_as_scipy_does_means_of_links() -> None:
    values, link = _clustered()
    theirs = stats.bootstrap(
        (values.reshape(40, 9).mean(axis=1),),
        np.mean,
        n_resamples=20_000,
        method="percentile",
        rng=np.random.default_rng(1),
    ).confidence_interval
    ours = cluster_bootstrap(values, link, seed=2, unit="m", draws=20_000)
    assert ours.value == pytest.approx(values.mean())
    wide = np.sqrt(40 / 39)
    assert ours.low - ours.value == pytest.approx(wide * (theirs.low - ours.value), rel=0.03)
    assert ours.high - ours.value == pytest.approx(wide * (theirs.high - ours.value), rel=0.03)
    assert ours.unit == "m"


def test_links_of_unequal_size_weigh_by_their_rows_and_gaps_do_not_count() -> None:
    values, link = np.array([1.0, 1.0, 1.0, 5.0, np.nan, np.inf]), np.array([0, 0, 0, 7, 7, 9])
    found = cluster_bootstrap(values, link, seed=0)
    assert found.value == pytest.approx(2.0)
    wide = np.sqrt(2)  # two links: the resamples are 1, 2 and 5
    assert found.low == pytest.approx(2 + wide * (1 - 2))
    assert found.high == pytest.approx(2 + wide * (5 - 2))


def test_a_statistic_is_given_sums_and_counts() -> None:
    values, link = _clustered()
    rms = cluster_bootstrap(values**2, link, 0, statistic=lambda total, n: np.sqrt(total / n))
    assert rms.value == pytest.approx(np.sqrt(np.mean(values**2)))
    assert rms.low < rms.value < rms.high


def test_the_seed_decides_and_500_draws_are_taken_unless_told() -> None:
    values, link = _clustered()
    assert cluster_bootstrap(values, link, 1) == cluster_bootstrap(values, link, 1, draws=500)
    assert cluster_bootstrap(values, link, 1) != cluster_bootstrap(values, link, 2)


@pytest.mark.parametrize(("values", "value"), [([1.0, 3.0], 2.0), ([np.nan, np.nan], np.nan)])
def test_one_link_or_no_value_has_an_infinite_interval(values, value) -> None:
    found = cluster_bootstrap(np.array(values), np.array([4, 4]), 0, "dB")
    assert found.value == pytest.approx(value, nan_ok=True)
    assert (found.low, found.high, found.unit) == (-np.inf, np.inf, "dB")


def test_no_value_at_all_is_not_a_number_whatever_the_statistic() -> None:
    nothing = np.full(4, np.nan)
    found = cluster_bootstrap(nothing, np.arange(4), 0, statistic=lambda total, n: total + 1)
    assert np.isnan(found.value)


def test_what_an_estimate_says() -> None:
    assert Estimate(2.0, 0.1, 4.0).above_zero
    assert not Estimate(2.0, 0.0, 4.0).above_zero
    # Normal: the one-sided bound lies 1.645 / 1.960 of the half width below the value.
    assert Estimate(1.0, -0.19, 2.0).likely_above_zero
    assert not Estimate(1.0, -0.20, 2.0).likely_above_zero
    assert str(Estimate(0.12345, -1, 2, "m")) == "0.123 m [-1, 2]"
    assert str(Estimate(0.5, 0.25, 1)) == "0.5 [0.25, 1]"
    assert str(Estimate(np.nan, -np.inf, np.inf, "m")) == "unknown"


def test_a_quantile_and_its_interval_are_those_of_resampled_links_written_out() -> None:
    rng = np.random.default_rng(5)
    link = np.repeat(np.arange(9), rng.integers(2, 7, 9))
    values = rng.gamma(1.0, 1.0, 9)[link] + 0.1 * rng.normal(size=len(link))
    found = cluster_quantile(np.r_[values, np.nan], np.r_[link, 3], 0.9, seed=6, unit="m")
    same = np.random.default_rng(6)
    picks = same.multinomial(9, np.full(9, 1 / 9), size=QUANTILE_DRAWS)
    drawn = [np.sort(np.repeat(values, pick[link])) for pick in picks]
    each = [some[int(np.ceil(0.9 * len(some))) - 1] for some in drawn]
    assert found.value == np.sort(values)[int(np.ceil(0.9 * len(values))) - 1]
    assert (found.low, found.high) == pytest.approx(np.percentile(each, [2.5, 97.5]))
    assert found.unit == "m"
    assert cluster_quantile(values, link, 1.0, 0).value == values.max()
    assert np.isnan(cluster_quantile(np.full(3, np.nan), np.arange(3), 0.5, 0).value)


def test_every_draw_of_a_quantile_counts_and_every_link_is_drawn_alike() -> None:
    # One row per link and thousands of links: neighbouring draws differ, so one more shows.
    values = np.random.default_rng(8).permutation(5000) ** 1.5
    found = cluster_quantile(values, 2 * np.arange(5000), 0.5, seed=9)
    picks = np.random.default_rng(9).multinomial(5000, np.full(5000, 1 / 5000), QUANTILE_DRAWS)
    each = [np.sort(np.repeat(values, pick))[2499] for pick in picks]
    assert (found.low, found.high) == pytest.approx(np.percentile(each, [2.5, 97.5]), rel=1e-12)
