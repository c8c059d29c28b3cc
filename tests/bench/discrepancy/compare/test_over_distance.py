"""What matching leaves of the distance is taken out; links that share simulated ones count less."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.over_distance import Walk, nearer, walks
from bench.discrepancy.compare.reuse import Reused
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.observables import Observables, Window
from bench.discrepancy.data.split import link_codes
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


def test_walks_are_those_of_the_simulated_table() -> None:
    over = walks(*_observed(80))
    assert over["rx_power_dbm"].slope == pytest.approx(-20, abs=1)
    assert over["peak_counts_db"].slope == pytest.approx(0, abs=1)
    assert over["kurtosis"].slope == pytest.approx(-9, abs=1)


def test_errors_walk_with_a_bend_as_those_of_a_leading_edge_do() -> None:
    observed, range_m, link = _observed(80)
    decades = np.log10(range_m)
    errors = -0.5 + 0.2 * decades + 0.15 * decades**2
    errors += 0.02 * np.random.default_rng(5).normal(size=80)[link] + 3.0 * (link == 7)
    observed.values[:, 0] = errors
    change = nearer(NAMES, walks(observed, range_m, link), np.array([9.0]), np.array([2.0]))[0, 0]
    far, near = np.log10(9), np.log10(2)
    truth = 0.2 * (far - near) + 0.15 * (far**2 - near**2)
    assert change == pytest.approx(truth, abs=0.02)


def test_walls_before_far_links_are_no_slope() -> None:
    observed, range_m, link = _observed(80)
    behind = (range_m > 4) & (link % 4 > 0)
    observed.values[:, 1] -= 8.0 * behind
    assert _decade(walks(observed, range_m, link)["rx_power_dbm"]) < -24
    over = walks(observed, range_m, link, behind.astype(np.intp))
    assert _decade(over["rx_power_dbm"]) == pytest.approx(-20, abs=1)


def _decade(walk: Walk) -> float:
    """Return what a walk does from 1 to 10 m."""
    return float(np.diff(walk.at(np.array([0.0, 1.0])))[0])


def test_few_links_leave_free_space() -> None:
    over = walks(*_observed(5))
    assert [over[name] for name in NAMES] == [Walk(0), Walk(-20), Walk(-20), Walk(0)]


def test_a_matched_row_ten_times_as_far_is_20_db_stronger_here() -> None:
    over = {"rx_power_dbm": Walk(-20.0)}
    change = nearer(NAMES, over, np.array([1.0, 5.0]), np.array([10.0, 0.0]))
    np.testing.assert_allclose(change, [[0, 20, 0, 0], [0, 0, 0, 0]])


def _table(lengths_m: np.ndarray, seed: int, scale: float = 0.0) -> pd.DataFrame:
    """Return a SIMULATED table of a row a link, errors of which walk by 0.4 m a decade."""
    noise = 0.01 * np.random.default_rng(seed).normal(size=len(lengths_m))
    error = 0.4 * np.log10(lengths_m) - 0.5 + scale * lengths_m + noise
    link = [f"L{seed}-{i}" for i in range(len(lengths_m))]
    return pd.DataFrame({"link": link, "true_range_m": lengths_m, "range_m": lengths_m + error})


@pytest.mark.parametrize("scale", [0.0, 0.004])
def test_another_mix_of_distances_is_no_error_but_a_scale_of_the_recordings_stays(
    scale: float,
) -> None:
    recorded = _table(np.linspace(10, 60, 60), 1, scale)
    simulated = _table(np.geomspace(6, 61, 60), 2)
    rows = np.arange(60)
    seen = view(recorded, link_codes(recorded), rows, Window(), None, False)
    left = TableComparison(simulated, Window()).ensemble(seen, (), 8).residual_of("error_m")
    slope, offset = np.polyfit(recorded["true_range_m"], left, 1)
    assert slope == pytest.approx(scale, abs=3e-4)
    assert offset == pytest.approx(0, abs=0.02)


def test_a_mix_without_far_links_says_nothing_of_far_ones() -> None:
    recorded = _table(np.linspace(10, 80, 70), 1)
    simulated = _table(np.append(np.linspace(10, 50, 69), 72.0), 2)
    inside = TableComparison(simulated, Window()).covered(recorded)
    assert inside[recorded["true_range_m"] < 45].all()
    assert not inside[recorded["true_range_m"] > 65].any()


def test_links_nearer_than_all_simulated_ones_by_far_take_no_part() -> None:
    far = np.array([1.0, 1.5, 2.0, *np.linspace(5, 30, 40)])
    recorded = pd.DataFrame({"link": [f"l{i}" for i in range(43)], "true_range_m": far})
    simulated = recorded[3:].assign(link=[f"s{i}" for i in range(40)])
    inside = TableComparison(simulated, Window()).covered(recorded)
    assert not inside[:3].any()  # within half a deviation in metres, and not of its logarithm
    assert inside[3:].all()


def _sharing(shares: np.ndarray) -> Reused:
    """Return what stands for recorded links by their shares alone."""
    return Reused(shares, np.zeros((len(shares), 1)), {"error_m": np.zeros((1, shares.shape[1]))})


def test_sums_over_links_that_share_one_scatter_more() -> None:
    weight, alone, same = np.ones(4), np.eye(4), np.ones((4, 1))
    assert _sharing(alone).widening(weight) == {"error_m": 1}
    assert _sharing(same).widening(weight) == {"error_m": pytest.approx(np.sqrt(20 / 8))}
    assert _sharing(same).widening(np.zeros(4)) == {"error_m": 1}
    assert _sharing(same).widening(np.array([1, -1, 1, -1.0])) == {"error_m": 1}  # none less


def test_a_search_over_shared_links_asks_for_more() -> None:
    rng = np.random.default_rng(0)
    versions = rng.normal(size=(9, 40, 1))
    ensemble = Ensemble(("error_m",), ("m",), versions, np.arange(40))
    known = Covariates({}, {})
    every = _sharing(np.full((40, 8), 0.125))
    plain, shared = (locate(ensemble, known, 0, reused=one) for one in (None, every))
    assert shared.z < plain.z
    assert shared.detectable["error_m"] > 1.5 * plain.detectable["error_m"]
    versions[0] += 20 * shared.detectable["error_m"]
    assert locate(ensemble, known, 0, reused=every).significant  # what is far off is seen


@pytest.mark.parametrize(("rows_off", "seen"), [(1, False), (2, True)])
def test_a_link_is_off_where_most_of_its_rows_are(rows_off: int, seen: bool) -> None:
    versions = np.random.default_rng(1).normal(0, 0.02, (9, 40, 1))
    versions[0, 6 : 6 + rows_off, 0] = 0.6
    ensemble = Ensemble(("error_m",), ("m",), versions, np.repeat(np.arange(20), 2))
    assert (rare_links(ensemble, 0) is not None) is seen


def test_one_link_that_missed_its_first_path_is_no_finding_beside_other_links() -> None:
    versions = np.random.default_rng(2).normal(0, 0.02, (17, 40, 1))
    versions[0, 6, 0] = 1.4
    one = Ensemble(("error_m",), ("m",), versions, np.arange(40))
    assert rare_links(one, 0) is not None  # rows that are simulated again have no such tail
    assert rare_links(one, 0, crowding=1.3) is None
    versions[0, 7:9, 0] = 1.1
    several = Ensemble(("error_m",), ("m",), versions, np.arange(40))
    assert rare_links(several, 0, crowding=1.3) is not None
