"""A stuck bit of the ranges is seen by what it leaves empty, and takes every name."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.select.range_word import stuck_bit_m

BIT_M = 0.075


def ranges(rows: int = 240) -> tuple[np.ndarray, np.ndarray]:
    """Return measured and true ranges [n] in metres that nothing is wrong with."""
    rng = np.random.default_rng(3)
    true = rng.uniform(5, 60, rows)
    return true + rng.normal(0, 0.03, rows), true


def is_set(range_m: np.ndarray, bit_m: float) -> np.ndarray:
    return np.floor(range_m / bit_m) % 2 == 1


@pytest.mark.parametrize("bit_m", [0.0375, 0.075, 0.15, 0.6])
@pytest.mark.parametrize("always", [True, False])
def test_a_stuck_bit_is_found_with_its_weight(bit_m: float, always: bool) -> None:
    measured, true = ranges()
    off = is_set(measured, bit_m)
    stuck = measured + bit_m * ~off if always else measured - bit_m * off
    assert stuck_bit_m(stuck, true) == pytest.approx(bit_m, rel=0.01)


def test_nothing_else_looks_like_a_stuck_bit() -> None:
    measured, true = ranges()
    rng = np.random.default_rng(4)
    rounded = 0.15 * np.rint(measured / 0.15)
    for other in (
        measured,
        measured + 0.3,
        rounded,
        rounded + rng.normal(0, 0.014, len(rounded)),
        np.floor(measured / 0.3) * 0.3 + rng.choice([0, 0.15], len(measured)),
        measured + np.where(rng.random(len(measured)) < 0.3, 0.4, 0.0),
    ):
        assert stuck_bit_m(other, true) is None


def test_places_that_lie_so_are_no_fault() -> None:
    _, true = ranges()
    there = true + BIT_M * ~is_set(true, BIT_M)
    assert stuck_bit_m(there, there) is None
    assert stuck_bit_m(there[:40], true[:40]) is None
