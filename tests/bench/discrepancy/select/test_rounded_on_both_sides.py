"""Ranges that both tables round alike leave no rounding out; a coarser grid is left out."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench

LINKS, ROWS = 60, 8


def table(seed: int, step_m: float) -> pd.DataFrame:
    """Return ranges of standing links that are rounded to a step; SIMULATED."""
    true_m = np.repeat(np.random.default_rng(7).uniform(2, 20, LINKS), ROWS)
    range_m = true_m + np.random.default_rng(seed).normal(0, 0.03, len(true_m))
    link = np.repeat([f"l{n}" for n in range(LINKS)], ROWS)
    rounded = step_m * np.rint(range_m / step_m) if step_m else range_m
    return pd.DataFrame({"link": link, "true_range_m": true_m, "range_m": rounded})


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("simulated_m", "names"),
    [(0.1, ()), (0.0, (("range-rounding",),)), (0.01, (("range-rounding",),))],
)
def test_only_a_grid_that_simulated_ranges_do_not_lie_on_is_left_out(
    simulated_m: float, names: tuple[tuple[str, ...], ...]
) -> None:
    found = bench.diagnose(table(1, 0.1), table(2, simulated_m))
    assert found.selection.names == names
    assert found.law is None
