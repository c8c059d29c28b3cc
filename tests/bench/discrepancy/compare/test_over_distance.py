"""What matching leaves of the distance is taken out; links that share simulated ones count less."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.over_distance import nearer, slopes
from bench.discrepancy.compare.reuse import widening
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.locate.permutation_test import locate, rare_links

NAMES = ("error_m", "rx_power_dbm", "peak_counts_db", "kurtosis")


def _observed(links: int, scatter: float = 0.5) -> tuple[Observables, np.ndarray, np.ndarray]:
    """Return a SIMULATED table: free space, a peak that is scaled, a kurtosis of -9 a decade."""
    rng = np.random.default_rng(4)
    link = np.repeat(np.arange(links), 2)
    range_m = rng.uniform(1, 10, links)[link]
    decades = np.log10(range_m)
    values = np.stack([range_m, -60 - 20 * decades, 0 * decades + 80, 30 - 9 * decades], axis=1)
    values[:, 1:] += scatter * rng.normal(size=(len(link), 3))
    return Observables(NAMES, ("m", "dB", "dB", "1"), values), range_m, link


def test_slopes_are_those_of_the_simulated_table() -> None:
    over = slopes(*_observed(80))
    assert "error_m" not in over
    assert over["rx_power_dbm"] == pytest.approx(-20, abs=1)
    assert over["peak_counts_db"] == pytest.approx(0, abs=1)
    assert over["kurtosis"] == pytest.approx(-9, abs=1)


def test_walls_before_far_links_are_no_slope() -> None:
    observed, range_m, link = _observed(80)
    behind = (range_m > 4) & (link % 4 > 0)
    observed.values[:, 1] -= 8.0 * behind
    assert slopes(observed, range_m, link)["rx_power_dbm"] < -24
    over = slopes(observed, range_m, link, behind.astype(np.intp))
    assert over["rx_power_dbm"] == pytest.approx(-20, abs=1)


def test_few_links_leave_free_space() -> None:
    over = slopes(*_observed(5))
    assert (over["rx_power_dbm"], over["peak_counts_db"], over["kurtosis"]) == (-20, -20, 0)


def test_a_matched_row_ten_times_as_far_is_20_db_stronger_here() -> None:
    change = nearer(NAMES, {"rx_power_dbm": -20.0}, np.array([1.0, 5.0]), np.array([10.0, 0.0]))
    np.testing.assert_allclose(change, [[0, 20, 0, 0], [0, 0, 0, 0]])


def test_sums_over_links_that_share_one_scatter_more() -> None:
    weight, alone = np.ones(4), np.eye(4) / 2
    assert widening(weight, alone) == 1
    assert widening(weight, np.full((4, 4), 0.5)) == pytest.approx(np.sqrt(12 / 6))
    assert widening(np.zeros(4), alone) == 1
    assert widening(np.array([1, -1, 1, -1.0]), np.full((4, 4), 0.5)) == 1  # cancels: none less


def test_a_search_over_shared_links_asks_for_more() -> None:
    rng = np.random.default_rng(0)
    versions = rng.normal(size=(9, 40, 1))
    ensemble = Ensemble(("error_m",), ("m",), versions, np.arange(40))
    known = Covariates({}, {})
    plain, shared = (
        locate(ensemble, known, 0, reused=one) for one in (None, np.full((40, 40), 0.125))
    )
    assert shared.z < plain.z
    assert shared.detectable["error_m"] > 1.5 * plain.detectable["error_m"]


@pytest.mark.parametrize(("rows_off", "seen"), [(1, False), (2, True)])
def test_a_link_is_off_where_most_of_its_rows_are(rows_off: int, seen: bool) -> None:
    versions = np.random.default_rng(1).normal(0, 0.02, (9, 40, 1))
    versions[0, 6 : 6 + rows_off, 0] = 0.6
    ensemble = Ensemble(("error_m",), ("m",), versions, np.repeat(np.arange(20), 2))
    assert (rare_links(ensemble, 0) is not None) is seen
