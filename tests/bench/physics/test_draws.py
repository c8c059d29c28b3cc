"""Draws of an effect: their law, and that a row has its own however many come with it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from bench.physics.randomness import CACHED, Draws
from bench.physics.units import phasor


def _complex(rows: int, samples: int = 50) -> np.ndarray:
    return Draws(3, 0, "noise", 1).complex_normal(rows, samples)


def test_complex_draws_are_normal_of_mean_power_one_and_circular() -> None:
    drawn = _complex(1000)
    for parts in (drawn.real, drawn.imag):
        assert kstest(parts.ravel() * np.sqrt(2), "norm").pvalue > 0.01
    assert abs(np.mean(np.abs(drawn) ** 2) - 1) < 0.02
    assert abs(np.mean(drawn**2)) < 0.02  # circular: parts of one variance, uncorrelated
    assert abs(np.corrcoef(drawn[:, :-1].real.ravel(), drawn[:, 1:].real.ravel())[0, 1]) < 0.02


def test_a_row_has_its_draws_however_many_rows_come_after_it() -> None:
    whole = _complex(3 * CACHED + 7)
    for rows in (1, CACHED - 1, CACHED, CACHED + 1, 2 * CACHED + 5):
        np.testing.assert_array_equal(_complex(rows), whole[:rows])


def test_no_rows_have_no_draws() -> None:
    assert _complex(0).shape == (0, 50)


def test_a_phasor_is_the_exponential_to_single_precision() -> None:
    turns = np.linspace(-1, 1, 1001, dtype=np.float32)
    off = np.abs(phasor(turns) - np.exp(2j * np.pi * turns.astype(np.float64)))
    assert off.max() < 1e-6


@pytest.mark.parametrize("before", [0, 3, 4])  # numpy holds half of its bits back after three
def test_complex_draws_are_made_of_the_uniform_ones_that_numpy_makes(before: int) -> None:
    one, other = Draws(3, 0, "noise", 1), Draws(3, 0, "noise", 1)
    np.testing.assert_array_equal(one.uniform(before), other.uniform(before))
    power, turn = other.uniform(CACHED, 2, 50).swapaxes(0, 1)
    expected = np.sqrt(-np.log(1 - power)) * np.exp(2j * np.pi * turn)
    np.testing.assert_allclose(one.complex_normal(CACHED, 50), expected, rtol=1e-5, atol=1e-5)
    np.testing.assert_array_equal(one.uniform(5), other.uniform(5))
