"""The arithmetic of the search, against answers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.chance import chance_beyond, told_apart
from bench.discrepancy.locate.detectable import of_all_rows, smallest_shift
from bench.discrepancy.locate.finding import _effect_rows, row_weights
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.locate.permutation_test import _clusters, _permuted, locate, rare_links
from bench.discrepancy.locate.rare import _link_offsets
from bench.discrepancy.settings import RARE_P

LINKS = np.array([0, 0, 1])
THREE = np.array([[9.0, 9.0, 9.0], [1.0, 1.0, 0.0], [0.0, 0.0, 2.0]])


def test_the_tail_of_permuted_maxima_goes_on_beyond_the_farthest() -> None:
    null = np.random.default_rng(0).exponential(1.0, 4999)
    assert chance_beyond(null, 1.0) == pytest.approx(np.exp(-1.0), rel=0.1)
    assert np.log(chance_beyond(null, 12.0)) == pytest.approx(-12.0, rel=0.1)
    assert chance_beyond(np.zeros(99), 3.0) == pytest.approx(0.01)


def test_what_lies_beyond_all_permutations_is_as_unlikely_as_their_tail_says() -> None:
    null = np.random.default_rng(0).exponential(1.0, 499)
    chance = told_apart(np.array([0.5, 0.002, 0.002]), null, np.array([0.7, -30.0, 2.0]))
    assert chance[1] < 1e-6  # a level of 0.001 can be reached
    assert (chance[0], chance[2]) == (0.5, 0.002)  # what permutations count stands


def test_the_noise_behind_the_smallest_shift_is_that_of_sums_over_links() -> None:
    # Sums (2, 0) and (0, 2): variances 2 + 2. Room: 9 x 2 / 3 - 1.5^2 x 5 / 3 = 2.25.
    assert smallest_shift(THREE, LINKS, 1.5) == pytest.approx(1.5 * np.sqrt(4 / 2.25))
    assert smallest_shift(THREE, LINKS, 2.0) == np.inf
    assert smallest_shift(THREE[:, 1:], LINKS[1:], 2.0) == np.inf  # no room at all, exactly


def test_with_one_simulated_version_the_noise_is_what_the_two_differ_by() -> None:
    # Differences 3, 1, 1 have the mean 5 / 3; sums about it 2 / 3 and -2 / 3; room 9 / 2 - 5 / 2.
    versions = np.array([[3.0, 3.0, 1.0], [0.0, 2.0, 0.0]])
    assert smallest_shift(versions, LINKS, 1.0) == pytest.approx(np.sqrt(4 / 9 / 2))


def test_unknown_rows_do_not_enter_the_smallest_shift() -> None:
    versions = np.full((3, 4, 2), np.nan)
    versions[:, :3, 0] = THREE
    versions[:2, 3, 0] = 50.0  # known in two versions of three
    ensemble = Ensemble(("error_m", "x"), ("m", "1"), versions, np.r_[LINKS, 1])
    assert of_all_rows(ensemble, 1.5) == {"error_m": pytest.approx(1.5 * np.sqrt(4 / 2.25))}


def test_the_offset_of_a_link_is_the_median_of_its_known_rows() -> None:
    code = np.array([1, 0, 2, 0, 1, 1, 3])
    values = np.array([1.0, 4.0, np.nan, np.nan, 2.0, 9.0, 7.0])
    assert _link_offsets(values, code).tolist() == pytest.approx([4, 2, np.nan, 7], nan_ok=True)


def _opposed(half_m: np.ndarray, struck_m: float) -> Ensemble:
    """Return two simulated versions at +/- half_m, and a recorded one at 0 but for one link."""
    recorded = np.zeros(len(half_m))
    recorded[3] = -struck_m
    versions = np.stack([recorded, half_m, -half_m])[..., None]
    return Ensemble(("error_m",), ("m",), versions, np.arange(len(half_m)))


def test_a_rare_link_is_beyond_a_normal_quantile_of_the_scatter() -> None:
    # Each simulated link is 1 cm from the other's; beside a mean of two it would be sqrt(3/4) cm.
    half, scatter = np.full(40, 0.005), 0.01 * np.sqrt(0.75)
    # 2 x 40 x sf(z) = 0.001 at z = 4.21
    assert rare_links(_opposed(half, 4.15 * scatter), 0) is None
    found = rare_links(_opposed(half, 4.3 * scatter), 0)
    assert found is not None
    assert (found.cell, found.p) == (Cell("error_m", "link", Place()), RARE_P)
    assert found.z == pytest.approx(4.3)
    assert (found.rows, found.links) == (40, 40)
    assert found.effect.value == pytest.approx(4.3 * scatter / 40 - 0.005)


def test_a_rare_link_is_beyond_twice_the_widest_simulated_link() -> None:
    half = np.full(400, 0.001)
    half[7] = 0.1
    widest = 0.2 * np.sqrt(0.75)
    assert rare_links(_opposed(half, 1.98 * widest), 0) is None
    assert rare_links(_opposed(half, 2.02 * widest), 0) is not None


def test_simulated_links_that_never_scatter_do_not_divide_by_zero() -> None:
    found = rare_links(_opposed(np.zeros(40), 0.01), 0)
    assert found is not None
    assert found.z == pytest.approx(0.01 / 1e-4)


def test_without_ranges_or_a_second_simulated_version_nothing_is_rare() -> None:
    ensemble = _opposed(np.full(40, 0.005), 1.0)
    assert rare_links(ensemble.first(1), 0) is None
    assert rare_links(Ensemble(("x",), ("1",), ensemble.versions, ensemble.links), 0) is None


def test_a_link_without_a_known_row_is_left_out() -> None:
    ensemble = _opposed(np.full(40, 0.005), 1.0)
    ensemble.versions[:, 5] = np.nan
    found = rare_links(ensemble, 0)
    assert found is not None
    assert found.links == 39


def test_the_statistic_is_the_sum_over_links_by_its_permutation_deviation() -> None:
    sums = np.zeros((2, 2, 2), np.float32)  # the second cell holds nothing
    sums[:, :, 0] = [[0.3, 0.1], [-0.3, -0.1]]  # 3 and 1 tenths: a deviation below one
    z, null = _permuted(sums, np.random.default_rng(0), 250)
    assert z == pytest.approx([4 / np.sqrt(10), 0])
    assert len(null) == 250
    assert set(np.round(null * np.sqrt(10), 4)) == {4.0, 2.0}
    assert np.mean(null > 1) == pytest.approx(0.5, abs=0.12)  # either version of every link


def test_links_are_grouped_where_there_are_over_eighty() -> None:
    rng = np.random.default_rng(0)
    assert _clusters(80, rng) is None
    groups = _clusters(165, rng)
    assert groups is not None
    ends = [int(165 * i / 80) for i in range(81)]
    assert list(map(len, groups)) == np.diff(ends).tolist()
    assert sorted(np.concatenate(groups)) == list(range(165))
    assert np.concatenate(groups).tolist() != list(range(165))


def _small() -> Ensemble:
    versions = np.array([[4.0, 1.0, np.nan], [0.0, 2.0, 1.0], [2.0, 4.0, 1.0]])
    return Ensemble(("error_m",), ("m",), versions[..., None], LINKS)


def test_rows_of_an_effect_are_recorded_minus_simulated() -> None:
    weight = np.array([-1.0, 1.0, 0.0])

    def rows(moment) -> list[float]:
        return _effect_rows(_small(), 0, Cell("error_m", moment, Place()), weight).tolist()

    assert rows("mean") == pytest.approx([3, -2, np.nan], nan_ok=True)
    assert rows("slope") == pytest.approx([-2.5, -2.5, np.nan], nan_ok=True)
    assert rows("spread") == pytest.approx([2, 1, np.nan], nan_ok=True)
    assert rows("link") == pytest.approx([-0.5, -0.5, np.nan], nan_ok=True)


def test_the_weight_of_a_cell_comes_from_its_group_number_or_observable() -> None:
    known = Covariates({"x": np.array([1.0, 2.0, 3.0])}, {"wall": np.array([True, False, True])})

    def weight(place: Place) -> list[float]:
        return row_weights(place, _small(), known).tolist()

    assert weight(Place()) == [1, 1, 1]
    assert weight(Place("wall")) == [1, 0, 1]
    assert weight(Place("x", 2.0, 3.0)) == [0, 1, 1]
    assert weight(Place("error_m", 1.0, 3.0)) == [0, 1, 0]


def _noise(width: float) -> Ensemble:
    versions = np.random.default_rng(2).normal(size=(7, 240, 1))
    versions[0] *= width
    return Ensemble(("error_m",), ("m",), versions, np.repeat(np.arange(40), 6))


def test_a_narrower_spread_counts_unless_only_wider_ones_do() -> None:
    nothing = Covariates({}, {})
    assert locate(_noise(0.2), nothing, 0, permutations=199).findings[0].cell.moment == "spread"
    assert not locate(_noise(0.2), nothing, 0, permutations=199, wider_only=True).findings
    wider = locate(_noise(4.0), nothing, 0, permutations=199, wider_only=True, top=1).findings
    assert [finding.z > 0 for finding in wider] == [True]


def test_crowding_widens_the_null_and_the_smallest_shift_with_it() -> None:
    nothing = Covariates({}, {})
    plain = locate(_noise(1.0), nothing, 0, permutations=199)
    wide = locate(_noise(1.0), nothing, 0, permutations=199, crowding=1.5)
    assert wide.threshold == plain.threshold
    assert wide.cells == 3
    assert 1.5 * wide.z == pytest.approx(plain.z)
    assert wide.detectable["error_m"] > plain.detectable["error_m"]
