"""Similar links stand for others only behind as many obstacles: three shelves are not one."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.matching import of_one_kind
from bench.discrepancy.compare.shared import alike
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import RANGE, Window
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


def test_rows_are_alike_behind_as_many_obstacles_of_a_kind() -> None:
    ours, theirs = alike(_table(1), _table(2))
    np.testing.assert_array_equal(ours, theirs)
    assert len(np.unique(ours)) == 4


@pytest.mark.parametrize("simulated", [3, 6])
def test_links_behind_more_obstacles_leave_no_error(simulated: int) -> None:
    recorded = _table(1)
    comparison = TableComparison(_table(2, simulated), Window())
    rows = np.arange(len(recorded))
    seen = view(recorded, link_codes(recorded), rows, Window(), None, False)
    made = comparison.ensemble(seen, (), 8)
    left = made.residual_of(RANGE)
    many = np.array([len(one) for one in recorded["obstacles"]])
    assert [left[many == one].mean() for one in range(4)] == pytest.approx([0] * 4, abs=0.01)


def test_a_row_of_another_kind_has_those_of_its_own_in_turns() -> None:
    ours, theirs = np.array([0, 1]), np.array([0, 0, 0, 1])
    own = [np.array([0, 3])]
    more = [np.array([1, 1]), np.array([3, 2]), np.array([2, 1])]
    made = of_one_kind(own, more, ours, theirs)
    assert [one.tolist() for one in made] == [[1, 3], [2, 3], [2, 3]]
