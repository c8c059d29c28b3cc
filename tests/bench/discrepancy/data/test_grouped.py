"""Sums over groups are those of numpy's own loop, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.data.grouped import group_means, group_sums, in_several


@pytest.mark.parametrize("columns", [0, 1, 7])
def test_sums_are_those_that_are_added_row_by_row(columns: int) -> None:
    rng = np.random.default_rng(columns)
    values = rng.normal(size=(200, columns)) * 10 ** rng.uniform(-8, 8, size=(200, columns))
    values[rng.random(values.shape) < 0.02] = np.nan
    values[rng.random(values.shape) < 0.1] = -0.0
    code = rng.integers(0, 40, 200)
    expected = np.zeros((45, columns))  # some groups have no rows
    np.add.at(expected, code, values)
    made = group_sums(values, code, 45)
    np.testing.assert_array_equal(made, expected)
    np.testing.assert_array_equal(np.signbit(made), np.signbit(expected))
    np.testing.assert_array_equal(group_sums(values[:, ::-1], code, 45), expected[:, ::-1])


def test_means_are_of_what_is_known() -> None:
    values = np.array([[1.0], [3.0], [np.nan], [7.0], [np.nan]])
    made = group_means(values, np.array([0, 0, 0, 2, 1]))
    np.testing.assert_array_equal(made, [[2.0], [2.0], [np.nan], [7.0], [np.nan]])


def test_groups_are_of_several_links_however_many_rows_these_have() -> None:
    code, links = np.array([0, 0, 1, 1, 3]), np.array([5, 5, 5, 9, 9])
    assert in_several(code, links, 4).tolist() == [False, True, False, False]
