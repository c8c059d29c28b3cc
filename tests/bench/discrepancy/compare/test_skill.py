"""The gain of one ensemble over another, by its definition."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import (
    Tally,
    alike,
    gain,
    gain_interval,
    gains,
    tally,
    weight_of,
)

NAMES, UNITS = ("error_m", "rx_power_dbm", "kurtosis"), ("m", "dB", "1")
LINKS, ROWS, MEMBERS = 20, 6, 8


def ensemble(seed: int, shift: float = 0.0, sizes: bool = False) -> Ensemble:
    """Return versions of noise; `shift` moves the recorded errors away from the simulated."""
    rng = np.random.default_rng(seed)
    links = np.repeat(np.arange(LINKS), ROWS)
    if sizes:
        links = np.sort(rng.integers(0, LINKS, LINKS * ROWS))
    versions = rng.normal(size=(1 + MEMBERS, len(links), 3)) * [0.1, 2.0, 1.0]
    versions[0, :, 0] += shift
    return Ensemble(NAMES, UNITS, versions, links)


def test_weights_of_observables_that_share_theirs() -> None:
    weights = {
        "error_m": 1.0,
        "rx_power_dbm": 0.4,
        "first_path_power_dbm": 0.4,
        "energy_db": 0.4,
        "max_amplitude_db": 0.4,
        "noise_std": 0.4,
        "preamble_count": 0.4,
        "profile_db_3": 0.15,
        "kurtosis": 0.25,
    }
    assert {name: weight_of(name) for name in weights} == weights


def test_a_tally_sums_scores_and_resolution_by_link() -> None:
    one = ensemble(0, sizes=True)
    found, scores = tally(one), one.scores()
    assert found.names == NAMES
    for code, link in enumerate(np.unique(one.links)):
        rows = one.links == link
        expected = (np.maximum(scores[rows], 0) + np.array([5e-4, 0.1, 0.05])).sum(axis=0)
        assert found.sums[code] == pytest.approx(expected)
        assert found.counts[code].tolist() == [rows.sum()] * 3


def test_rows_without_a_score_are_not_counted() -> None:
    one = ensemble(1)
    one.versions[0, :3, 1] = np.nan
    found = tally(one)
    assert found.counts[0].tolist() == [ROWS, ROWS - 3, ROWS]
    left = np.maximum(one.scores()[3:ROWS, 1], 0) + 0.1
    assert found.sums[0, 1] == pytest.approx(left.sum())


def _log_means(one: Tally) -> np.ndarray:
    return np.log(one.sums.sum(axis=0) / one.counts.sum(axis=0))


def test_a_gain_is_weight_times_the_logarithm_of_the_ratio_of_mean_scores() -> None:
    far, near = tally(ensemble(2, shift=0.3)), tally(ensemble(2, shift=0.1))
    expected = [1.0, 0.4, 0.25] * (_log_means(far) - _log_means(near))
    assert list(gains(far, near).values()) == pytest.approx(expected.tolist())
    assert list(gains(far, near)) == list(NAMES)
    assert gain(far, near) == pytest.approx(expected.sum())
    assert gain(near, far) == pytest.approx(-expected.sum())
    assert gain(far, near) > 0.3


def test_only_observables_both_have_are_compared_by_name() -> None:
    far, near = tally(ensemble(3, 0.3)), tally(ensemble(3))
    other = near.keep(("kurtosis", "error_m"))
    assert other.names == ("kurtosis", "error_m")
    assert other.sums == pytest.approx(near.sums[:, [2, 0]])
    assert other.counts == pytest.approx(near.counts[:, [2, 0]])
    assert set(gains(far, other)) == {"error_m", "kurtosis"}
    assert gains(far, other)["error_m"] == pytest.approx(gains(far, near)["error_m"])


def test_tallies_of_other_links_stand_beside() -> None:
    one, two = tally(ensemble(4)), tally(ensemble(5)).keep(("error_m", "kurtosis"))
    both = one.beside(two)
    assert both.names == ("error_m", "kurtosis")
    assert both.sums == pytest.approx(np.concatenate([one.sums[:, [0, 2]], two.sums]))
    assert both.counts == pytest.approx(np.concatenate([one.counts[:, [0, 2]], two.counts]))


def _resampled(far: Tally, near: Tally, seed: int) -> np.ndarray:
    """Return the gains of 400 resamples of links, drawn and summed one by one."""
    rng = np.random.default_rng(seed)
    pick = rng.multinomial(LINKS, np.full(LINKS, 1 / LINKS), size=400)
    out = []
    for draw in pick:
        means = [(draw @ one.sums) / (draw @ one.counts) for one in (far, near)]
        out.append(([1.0, 0.4, 0.25] * np.log(means[0] / means[1])).sum())
    return np.array(out)


def test_the_interval_of_a_large_gain_is_that_of_resampled_links() -> None:
    far, near = tally(ensemble(6, shift=2.0)), tally(ensemble(6))
    found, drawn = gain_interval(far, near, seed=9), _resampled(far, near, 9)
    assert found.value == pytest.approx(gain(far, near))
    assert found.value > 1
    low, high = np.percentile(drawn, [2.5, 97.5]) - found.value
    wide = np.sqrt(LINKS / (LINKS - 1))
    assert found.low == pytest.approx(found.value + wide * low)
    assert found.high == pytest.approx(found.value + wide * high)
    assert found.unit == "nats"


@pytest.mark.parametrize("gaps", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_the_interval_of_a_small_gain_is_that_of_differences(turned: bool, gaps: bool) -> None:
    worlds = ensemble(7, shift=0.12), ensemble(7)
    for world in worlds if gaps else ():
        world.versions[0, ::2, 1] = np.nan
        world.versions[0, :, 1] *= 1.4 if world is worlds[0] else 1.0
    far, near = map(tally, worlds)
    left, right = (near, far) if turned else (far, near)
    found = gain_interval(left, right, seed=1)
    assert 0 < abs(found.value) < 1
    rng = np.random.default_rng(1)
    pick = rng.multinomial(LINKS, np.full(LINKS, 1 / LINKS), size=400)
    typical = left.sums.sum(axis=0) / left.counts.sum(axis=0)
    draws = np.concatenate([np.ones((1, LINKS), np.int64), pick])
    change = (draws @ left.sums) / (draws @ left.counts) - (draws @ right.sums) / (
        draws @ right.counts
    )
    linear = (np.array([1.0, 0.4, 0.25]) * change / typical).sum(axis=1)
    drawn = linear[1:] * (found.value / linear[0])
    low, high = np.percentile(drawn, [2.5, 97.5]) - found.value
    wide = np.sqrt(LINKS / (LINKS - 1))
    assert found.low == pytest.approx(found.value + wide * low)
    assert found.high == pytest.approx(found.value + wide * high)


def test_named_observables_alone_are_in_the_interval() -> None:
    far, near = tally(ensemble(8, 0.3)), tally(ensemble(8))
    found = gain_interval(far, near, 0, names=("error_m", "absent"))
    assert found.value == pytest.approx(gains(far, near)["error_m"])
    assert gain_interval(far, near, 0).value == pytest.approx(gain(far, near))


def test_an_unknown_unit_has_no_resolution() -> None:
    one = ensemble(10)
    other = tally(Ensemble(NAMES, ("m", "furlong", "1"), one.versions, one.links))
    assert (tally(one).sums - other.sums)[:, 1] == pytest.approx(0.1 * ROWS)


def test_two_links_have_an_interval() -> None:
    one = Tally(("error_m",), np.array([[2.0], [3.0]]), np.array([[4.0], [4.0]]))
    two = Tally(("error_m",), np.array([[1.0], [2.5]]), np.array([[4.0], [4.0]]))
    assert np.isfinite(gain_interval(one, two, 0).low)


def test_one_link_has_an_infinite_interval() -> None:
    one = Tally(("error_m",), np.array([[2.0]]), np.array([[4.0]]))
    two = Tally(("error_m",), np.array([[1.0]]), np.array([[4.0]]))
    found = gain_interval(one, two, 0)
    assert found.value == pytest.approx(np.log(2))
    assert (found.low, found.high) == (-np.inf, np.inf)


def test_an_observable_that_no_row_has_gains_nothing() -> None:
    one = Tally(("error_m", "noise_std"), np.array([[2.0, 0.0]] * 2), np.array([[4.0, 0.0]] * 2))
    assert gains(one, one) == {"error_m": 0.0, "noise_std": 0.0}
    assert np.isfinite(gain_interval(one, one, 0).value)


def test_gains_on_the_same_links_are_told_from_gains_on_others() -> None:
    counts = np.full((LINKS, 1), 4.0)
    base = Tally(("error_m",), np.full((LINKS, 1), 4.0), counts)
    first, second = np.ones((LINKS, 1)) * 3, np.ones((LINKS, 1)) * 3
    first[: LINKS // 2], second[LINKS // 2 :] = 1.0, 1.0
    one, other = Tally(("error_m",), first, counts), Tally(("error_m",), second, counts)
    assert alike(base, one, one) == pytest.approx(1.0)
    assert alike(base, one, other) == pytest.approx(-1.0)
    assert alike(base, base, other) == 1.0  # what gains nothing anywhere differs from nothing
