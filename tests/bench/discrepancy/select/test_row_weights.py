"""Rows that noise scatters more count for less, and a mean that links keep is no scatter."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.select.row_weights import row_weights

LEVEL = np.repeat(np.linspace(-90.0, -65.0, 60), 4)
LINKS = np.repeat(np.arange(60), 4)


def test_weak_rows_that_scatter_more_count_for_less() -> None:
    rng = np.random.default_rng(0)
    sigma = 0.02 * np.sqrt(1 + 10 ** ((-77.5 - LEVEL) / 10))
    weights = row_weights(sigma * rng.normal(size=240), LEVEL, LINKS)
    told = sigma * weights / np.median(sigma * weights)
    assert weights[0] < 0.5 < 1.0 < weights[-1]
    assert told.max() < 1.5
    assert told.min() > 0.65


@pytest.mark.parametrize("per_db_m", [0.0, 0.01])
def test_rows_that_scatter_alike_count_alike_though_ranges_follow_the_level(
    per_db_m: float,
) -> None:
    rng = np.random.default_rng(1)
    left = per_db_m * np.maximum(-75 - LEVEL, 0) + rng.normal(0, 0.02, 240)
    assert row_weights(left, LEVEL, LINKS) == pytest.approx(1.0)


def test_nothing_is_weighed_where_links_have_one_row_or_levels_lack() -> None:
    left = np.random.default_rng(2).normal(size=240)
    assert (row_weights(left, LEVEL, np.arange(240)) == 1).all()
    assert (row_weights(left, np.where(LEVEL < -80, np.nan, LEVEL), LINKS) == 1).all()
