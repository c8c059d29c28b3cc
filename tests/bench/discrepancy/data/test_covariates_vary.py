"""A column that differs in its last digits alone is constant."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.data.covariates import covariates


def test_rounding_noise_of_a_constant_is_no_covariate() -> None:
    n = np.arange(40)
    frame = pd.DataFrame(
        {
            "reply_time_s": 0.15 + 1e-9 * (n % 4),
            "time_s": 1.7e9 + 0.1 * n,
            "battery_v": 5e-324 * (n % 2),
            "tx_x_m": 4.5e5 + 0.5 * (n % 7),
            "true_range_m": 1.0 + n,
        }
    )
    assert set(covariates(frame).numbers) == {"time_s", "tx_x_m", "true_range_m"}
