"""Similar links stand for others only behind as many obstacles: three shelves are not one."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.over_kinds import over_kinds
from bench.discrepancy.compare.shared import alike
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import RANGE, Observables, Window
from bench.discrepancy.data.split import link_codes

STEP_M = 0.05  # that a shelf delays, on both sides


def _table(seed: int, rows: int = 3) -> pd.DataFrame:
    """Return SIMULATED ranges of 60 links behind none to three shelves, the same for every seed."""
    link, rng = np.repeat(np.arange(60), rows), np.random.default_rng(seed)
    truth = 5.0 + 0.01 * link
    error = STEP_M * (link % 4) + 0.01 * rng.normal(size=len(link))
    shelves = [["shelf"] * (one % 4) for one in link]
    return pd.DataFrame(
        {"link": link.astype(str), "true_range_m": truth, "range_m": truth + error}
    ).assign(obstacles=shelves)


def _left(recorded: pd.DataFrame, simulated: pd.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    """Return recorded minus simulated range of every row in metres, and how many shelves it has."""
    rows, comparison = np.arange(len(recorded)), TableComparison(simulated, Window())
    seen = view(recorded, link_codes(recorded), rows, Window(), None, False)
    many = np.array([len(one) for one in recorded["obstacles"]])
    return comparison.ensemble(seen, (), 8).residual_of(RANGE), many


def test_rows_are_alike_behind_as_many_obstacles_of_a_kind() -> None:
    ours, theirs = alike(_table(1), _table(2))
    np.testing.assert_array_equal(ours, theirs)
    assert len(np.unique(ours)) == 4


@pytest.mark.parametrize("simulated", [3, 6])
def test_links_behind_more_obstacles_leave_no_error(simulated: int) -> None:
    left, many = _left(_table(1), _table(2, simulated))
    assert [left[many == one].mean() for one in range(4)] == pytest.approx([0] * 4, abs=0.01)


@pytest.mark.parametrize("late_m", [0.0, 0.1])
def test_what_only_recordings_have_behind_obstacles_stays(late_m: float) -> None:
    recorded, simulated = _table(1), _table(2)
    recorded["range_m"] += late_m * np.array([len(one) == 3 for one in recorded["obstacles"]])
    left, many = _left(recorded, simulated)
    assert [left[many == one].mean() for one in range(4)] == pytest.approx(
        [0, 0, 0, late_m], abs=0.01
    )


def test_a_kind_that_no_simulated_link_has_changes_nothing() -> None:
    names, theirs = (RANGE,), np.repeat([0, 1], 30)
    values = np.where(theirs == 1, 0.2, 0.0)[:, None] + 0.01 * np.arange(60)[:, None] % 0.02
    observed = Observables(names, ("m",), values)
    links = np.arange(60)
    made = over_kinds(observed, {}, np.full(60, 5.0), links, np.array([0, 1, 2]), theirs)
    change = made.change((RANGE, "rx_power_dbm"), np.array([59, 0, 0]))
    np.testing.assert_allclose(change, [[-0.2, 0], [0.2, 0], [0, 0]], atol=0.01)
