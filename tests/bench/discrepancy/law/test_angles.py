"""What goes round has harmonics; a tilt that never does has steps and lines like any number."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.material import material
from bench.discrepancy.law.screen import promising

ROWS = 240


@pytest.mark.parametrize(
    ("column", "low", "high", "round_"),
    [
        ("flap_deg", 0.0, 80.0, False),
        ("tilt_rad", -0.4, 0.9, False),
        ("turn_deg", 0.0, 300.0, True),
        ("azimuth_deg", 0.0, 80.0, True),
    ],
)
def test_angles_of_less_than_half_a_turn_do_not_go_round(
    column: str, low: float, high: float, round_: bool
) -> None:
    rng = np.random.default_rng(0)
    value = rng.uniform(low, high, ROWS)
    left_m = 0.1 * (value > (low + high) / 2) + rng.normal(0, 0.02, ROWS)
    every = material(pd.DataFrame({column: value}), left_m, np.arange(ROWS) // 5)
    laws = promising(every, float(ROWS))
    best = max(laws, key=lambda law: law.fitted(every).fit.likelihood)
    assert ("sin(" in best.expression) is round_
    assert best.expression.startswith(f"a * ({column} > x0)") is not round_
