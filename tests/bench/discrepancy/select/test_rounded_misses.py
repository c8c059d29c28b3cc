"""Where both sides lie on one grid ranges differ by whole steps: they are not farther for that."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.confirm import served
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.physics.effects.ranging.range_rounding import RangeRounding

STEP_M = 0.05
LINK = np.repeat(np.arange(60), 4)


def _measured(seed: int, to_grid: bool) -> pd.DataFrame:
    """Return ranges with 2 cm of scatter and 3 cm that links keep; SIMULATED."""
    rng, true = np.random.default_rng(seed), np.linspace(3, 20, 60)[LINK]
    range_m = true + 0.02 * rng.normal(size=len(LINK)) + (0.03 * rng.normal(size=60))[LINK]
    range_m = np.rint(range_m / STEP_M) * STEP_M if to_grid else range_m
    named = {"link": [f"l{i}" for i in LINK], "true_range_m": true}
    return pd.DataFrame({**named, "range_m": range_m, "error_m": range_m - true})


def test_a_grid_makes_no_range_farther() -> None:
    recorded, simulated = _measured(1, True), _measured(2, False)
    rows = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    comparison = TableComparison(simulated, Window())
    made = served(comparison, rows, (RangeRounding(step_m=STEP_M),), 0)
    assert made.medians_m[0] == made.medians_m[1]
    assert made.serves
