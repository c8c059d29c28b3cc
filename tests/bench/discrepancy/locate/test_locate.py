"""The search finds what is there, and finds nothing where nothing is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates, covariates
from bench.discrepancy.locate.hypotheses import link_sums
from bench.discrepancy.locate.permutation_test import locate

LINKS, ROWS, MEMBERS = 24, 12, 12


def _comparison(seed: int, shift=None, link_sd: float = 0.5) -> tuple[Ensemble, Covariates]:
    """Return rows whose link offsets dwarf the noise: tests over rows would be fooled."""
    rng = np.random.default_rng(seed)
    links = np.repeat(np.arange(LINKS), ROWS)
    n = len(links)
    versions = rng.normal(size=(1 + MEMBERS, n, 3)) * 0.1
    versions += (rng.normal(size=(1 + MEMBERS, LINKS, 3)) * link_sd)[:, links]
    known = Covariates({"distance": rng.uniform(1, 10, n)}, {"wall": rng.uniform(size=n) < 0.3})
    if shift is not None:
        versions[0, :, 0] += shift(known)
    names = ("error_m", "rx_power_dbm", "noise_std")
    return Ensemble(names, ("m", "dB", "counts"), versions, links), known


def test_false_alarms_stay_at_the_level_although_rows_of_a_link_depend():
    alarms = sum(
        locate(*_comparison(seed), seed=seed, permutations=99).significant for seed in range(60)
    )
    assert alarms <= 8  # binomial(60, 0.05): more than 8 has probability 0.3 %


def test_finds_the_group_and_the_size():
    ensemble, known = _comparison(3, lambda c: 0.4 * c.groups["wall"], link_sd=0.02)
    top = locate(ensemble, known, seed=0).findings[0]
    assert (top.cell.observable, top.cell.place.covariate) == ("error_m", "wall")
    assert top.effect.low < 0.4 < top.effect.high
    assert top.effect.unit == "m"


def test_finds_an_effect_that_cancels_in_mean_and_spread_of_all_rows():
    ensemble, known = _comparison(
        4, lambda c: 0.3 * np.sign(c.numbers["distance"] - np.median(c.numbers["distance"])), 0.02
    )
    located = locate(ensemble, known, seed=0)
    assert located.findings[0].cell.place.covariate == "distance"


def test_what_is_off_everywhere_is_told_over_all_rows_however_even_it_is_somewhere():
    ensemble, known = _comparison(3, lambda c: np.full(LINKS * ROWS, 0.4), link_sd=0.02)
    ensemble.versions[:, ~known.groups["wall"], 0] *= 3  # the same, less even outside the group
    ensemble.versions[0, :, 0] = 0.4 + ensemble.versions[1, :, 0]
    top = locate(ensemble, known, seed=0).findings[0]
    assert top.cell.place.covariate == "wall"
    assert top.told.cell.place.covariate is None
    assert top.told.effect.low < 0.4 < top.told.effect.high


def test_what_is_clearly_larger_in_a_place_is_told_there():
    ensemble, known = _comparison(3, lambda c: np.full(LINKS * ROWS, 0.4), link_sd=0.02)
    whole = locate(ensemble, known, seed=0).findings[0]
    for times, there in ((1.2, False), (2.0, True)):
        larger = replace(whole, effect=Estimate(0.4 * times, 0.3, 1.0, "m"), whole=whole)
        assert (larger.told is larger) is there


def test_finds_link_constants_of_either_sign():
    rng = np.random.default_rng(5)
    ensemble, known = _comparison(5, link_sd=0.0)
    ensemble.versions[0, :, 0] += rng.choice([-0.3, 0.3], LINKS)[ensemble.links]
    found = locate(ensemble, known, seed=0).findings
    assert found
    assert all(f.cell.observable == "error_m" for f in found)


def test_same_seed_same_answer_and_smallest_detectable_is_in_units():
    comparison = _comparison(6)
    first, second = locate(*comparison, seed=1), locate(*comparison, seed=1)
    assert first == second
    assert 0.05 < first.detectable["error_m"] < 1.5
    shifted = _comparison(6, lambda c: 2 * first.detectable["error_m"])
    assert locate(*shifted, seed=1).significant


def test_the_recorded_version_counts_among_its_own_permutations():
    # So p is never below 1 / (permutations + 1): with 19 of them nothing is rarer than 5 %.
    ensemble, known = _comparison(8, lambda c: 5.0 * c.groups["wall"])
    located = locate(ensemble, known, seed=0, alpha=0.05, permutations=19)
    assert located.p == 1 / 20
    assert min(f.p for f in located.findings) == 1 / 20


def test_links_are_summed_cluster_by_cluster_as_if_all_were_held_at_once():
    ensemble, known = _comparison(7)
    cells, each = link_sums(ensemble, known)
    clusters = np.split(np.random.default_rng(0).permutation(LINKS), [1, 5, 16])
    same, sums = link_sums(ensemble, known, clusters)
    assert same == cells
    for i, links in enumerate(clusters):
        assert np.allclose(sums[:, i], each[:, links].sum(axis=1), atol=1e-4)
    assert np.abs(each.mean(axis=0)).max() < 1e-4


def test_covariates_take_numbers_groups_obstacles_and_unknown_extras():
    frame = pd.DataFrame(
        {
            "error_m": [0.1, 0.2, 0.3, 0.4],
            "true_range_m": [1.0, 2.0, 3.0, 4.0],
            "constant": [1.0] * 4,
            "humidity": [0.1, 0.2, 0.1, 0.3],
            "tx": ["a", "a", "b", "b"],
            "rx": ["c", "d", "c", "d"],
            "obstacle_thickness_m": [[0.1], [], [0.1, 0.2], []],
            "obstacles": [["wall"], [], ["wall", "door"], []],
        }
    )
    found = covariates(frame)
    assert set(found.numbers) == {"true_range_m", "humidity"}
    assert found.groups["obstacle=wall"].tolist() == [True, False, True, False]
    assert found.groups["obstructed"].tolist() == [True, False, True, False]
    assert {"tx=a", "rx=d", "pair=b->c"} <= set(found.groups)


@pytest.mark.parametrize("links", [90, 400])
def test_many_links_are_grouped_and_still_found(links):
    rng = np.random.default_rng(7)
    versions = rng.normal(size=(9, links * 3, 1))
    versions[0] += 0.6
    ensemble = Ensemble(("error_m",), ("m",), versions, np.repeat(np.arange(links), 3))
    found = locate(ensemble, Covariates({}, {}), seed=0).findings
    assert found[0].effect.value == pytest.approx(0.6, abs=0.2)
