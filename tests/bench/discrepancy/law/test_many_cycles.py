"""What repeats a hundred times along a column is a law: as many cycles show as rows can tell."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.search import ranking
from bench.discrepancy.law.settings import LAW_NATS

ROWS, RIM_M, PADDLE_M = 300, 90.0, 0.83


def turned(swing_m: float, seed: int) -> Material:
    """Return rows of a wheel whose paddles pass some hundred times."""
    rng = np.random.default_rng(seed)
    rim_m = rng.uniform(0.0, RIM_M, ROWS)
    left_m = swing_m * np.sin(2 * np.pi * rim_m / PADDLE_M) + rng.normal(0.0, 0.02, ROWS)
    return material(pd.DataFrame({"rim_m": rim_m}), left_m, np.arange(ROWS) // 5)


def test_a_hundred_cycles_are_one_law() -> None:
    best = ranking(turned(0.03, 1)).candidates[0]
    period = next(value for name, value, _ in best.fitted.constants if name == "period")
    assert period == pytest.approx(PADDLE_M, rel=0.002)


def test_noise_has_no_period() -> None:
    best = [ranking(turned(0.0, seed)).candidates[0].nats for seed in range(20)]
    assert sum(nats > LAW_NATS for nats in best) <= 1
