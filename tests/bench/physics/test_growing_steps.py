"""Ranges rounded to steps that grow with the range, as compressed codes do."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.effects.ranging.range_rounding import (
    GROWTHS,
    RangeRounding,
    evened,
    unevened,
)

TRUE_M = np.random.default_rng(1).uniform(3, 40, 300)
PLAIN_M = TRUE_M + 0.03 * np.random.default_rng(2).normal(size=300)


def _found(range_m: np.ndarray) -> RangeRounding | None:
    frame = pd.DataFrame({"range_m": range_m, "true_range_m": TRUE_M})
    found = RangeRounding.fit_values(frame, range_m - TRUE_M)
    assert found is None or isinstance(found, RangeRounding)
    return found


def test_roots_in_whole_steps_are_found_and_made_again() -> None:
    kept = np.square(0.017 * np.rint(np.sqrt(PLAIN_M) / 0.017))
    found = _found(kept)
    assert found is not None
    assert found.growth == 0.5
    steps_m = found.step_at(np.array([4.0, 36.0]))
    assert steps_m == pytest.approx([2 * 0.017 * 2, 2 * 0.017 * 6], rel=0.01)
    again = unevened(
        found.step_m * found.place(PLAIN_M) + found.origin_m, found.growth, found.reference_m
    )
    assert np.mean(np.abs(again - kept) < 0.005) > 0.9


def test_logarithms_in_whole_steps_are_found() -> None:
    found = _found(np.exp(0.01 * np.rint(np.log(PLAIN_M) / 0.01)))
    assert found is not None
    assert found.growth == 1.0
    assert found.step_at(np.array([10.0]))[0] == pytest.approx(0.1, rel=0.02)


def test_squares_in_whole_steps_are_found() -> None:
    found = _found(np.sqrt(3.0 * np.rint(PLAIN_M**2 / 3.0)))
    assert found is not None
    assert found.growth == -1.0
    assert found.step_at(np.array([10.0]))[0] == pytest.approx(3.0 / (2 * 10.0), rel=0.02)


def test_even_steps_stay_even_and_scatter_is_no_grid() -> None:
    found = _found(0.15 * np.rint(PLAIN_M / 0.15))
    assert found is not None
    assert found.growth == 0.0
    assert _found(PLAIN_M) is None


def test_scales_lead_back() -> None:
    for growth in GROWTHS:
        assert unevened(evened(TRUE_M, growth, 7.0), growth, 7.0) == pytest.approx(TRUE_M)
