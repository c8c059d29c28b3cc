"""Rows that scatter within links are seen beside a single simulated version; SIMULATED rows."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.permutation_test import locate
from bench.discrepancy.locate.row_scatter import about_links, row_scatter

LINKS, ROWS = 30, 8
CODE = np.repeat(np.arange(LINKS), ROWS)


def compared(seed: int, wider: float, members: int = 1) -> Ensemble:
    """Return rows of links that are off by metres by chance; recorded rows scatter `wider`."""
    rng = np.random.default_rng(seed)
    versions = rng.normal(0, 0.02, (1 + members, LINKS * ROWS, 1))
    versions[0] *= wider
    versions += rng.normal(0, 0.5, (1 + members, LINKS, 1))[:, CODE]
    return Ensemble(("error_m",), ("m",), versions, CODE)


@pytest.mark.parametrize("members", [1, 4])
def test_rows_that_scatter_wider_are_found_whatever_links_have_of_their_own(members: int) -> None:
    ensemble = compared(1, 4.0, members)
    none, scatter = Covariates({}, {}), row_scatter(ensemble)
    if members == 1:  # either version is as far from the mean of both
        assert not locate(ensemble, none, 0).significant
    found = locate(ensemble, none, 0, scatter=scatter).findings
    (told,) = [one for one in found if one.cell.moment == "rows"]
    more_m = 3 * 0.02 * np.sqrt(2 / np.pi) * np.sqrt(1 - 1 / ROWS)
    assert told.effect.value == pytest.approx(more_m, rel=0.25)
    assert "scatter of rows within links" in str(told)


def test_rows_that_scatter_alike_alarm_one_time_in_twenty() -> None:
    none, alarms = Covariates({}, {}), 0
    for seed in range(60):
        ensemble = compared(seed, 1.0)
        found = locate(ensemble, none, seed, permutations=99, scatter=row_scatter(ensemble))
        alarms += found.significant
    assert alarms <= 8  # binomial(60, 0.05): more than 8 has probability 0.3 %


def test_unknown_rows_and_links_of_one_row_say_nothing() -> None:
    ensemble = compared(1, 4.0)
    ensemble.versions[0, CODE == 2] = np.nan
    ensemble.versions[1, (CODE == 3) & (np.arange(len(CODE)) % ROWS > 0)] = np.nan
    scatter = row_scatter(ensemble)
    assert np.isfinite(scatter).all()
    assert (scatter[:, [2, 3]] == 0).all()
    assert (scatter[0] > scatter[1]).sum() >= LINKS - 3


def test_how_far_rows_are_from_their_link() -> None:
    values = np.array([[1.0, 3.0, 5.0, np.nan]])
    found = about_links(values, np.array([0, 0, 7, 7]))
    assert found[0, :3].tolist() == [1.0, 1.0, 0.0]


def test_counts_of_symbols_scatter_by_whole_numbers_and_say_nothing() -> None:
    ensemble = compared(1, 4.0)
    counts = Ensemble(("preamble_count",), ("symbols",), ensemble.versions, CODE)
    assert (row_scatter(counts) == 0).all()


@pytest.mark.parametrize("members", [1, 3, 4])
def test_a_column_of_one_value_hides_nothing(members: int) -> None:
    """A mean of a constant is off it by rounding, which is no scatter for others to exceed."""
    moving = compared(1, 4.0, members)
    fixed = np.full((*moving.versions.shape[:2], 1), 72.1)
    fixed[1:] *= 1 + np.finfo(np.float64).eps * np.arange(members)[:, None, None]
    versions = np.concatenate([moving.versions, fixed], axis=2)
    both = Ensemble(("error_m", "noise_std"), ("m", "counts"), versions, CODE)
    none = Covariates({}, {})
    with_it = locate(both, none, 0, scatter=row_scatter(both))
    alone = locate(moving, none, 0, scatter=row_scatter(moving))
    assert with_it.threshold == pytest.approx(alone.threshold, rel=1e-3)
    assert [one.cell for one in with_it.findings] == [one.cell for one in alone.findings]
    assert set(with_it.detectable) == {"error_m"}
