"""A constant that most rows do not show is none."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.sets.spared import most_are_spared


@pytest.mark.parametrize("seed", range(3))
def test_a_third_of_the_rows_makes_no_constant(seed: int) -> None:
    rng = np.random.default_rng(seed)
    struck = rng.random(270) < 0.3
    noise = rng.normal(0, 0.05, 270)
    assert most_are_spared(noise + struck * rng.uniform(0.6, 1.0, 270), 0.25)
    few = (rng.random(270) < 0.1) * rng.uniform(0.6, 1.0, 270)
    assert not most_are_spared(noise + 0.12 + few, 0.18)
    assert not most_are_spared(0.08 * rng.standard_t(3, 270) + 0.12, 0.12)
