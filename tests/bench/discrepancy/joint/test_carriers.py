"""Samples of many carriers go together over many samples, as no noise does; SIMULATED."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.discrepancy.joint.carriers import carried

ROWS, SAMPLES = 250, 60
QUIET = np.arange(SAMPLES) < 16


def noise(seed: int) -> NDArray[np.complex128]:
    """Return noise of a receiver whose filter makes neighbours alike."""
    rng = np.random.default_rng(seed)
    made = rng.normal(size=(2, ROWS, SAMPLES + 2))
    white = made[0] + 1j * made[1]
    return np.asarray(white[:, 2:] + 0.6 * white[:, 1:-1] + 0.2 * white[:, :-2])


def carriers(count: int, seed: int = 5) -> NDArray[np.complex128]:
    """Return carriers side by side, of phases of their own in every row."""
    begins = np.random.default_rng(seed).uniform(-np.pi, np.pi, (ROWS, count, 1))
    places = np.arange(SAMPLES) * (0.4 + 0.9 * np.arange(count)[:, None])
    return np.asarray(np.exp(1j * (begins + places)).sum(axis=1) / np.sqrt(count))


def tail() -> NDArray[np.float64]:
    """Return echoes that die away, louder in some rows."""
    loud = np.random.default_rng(9).exponential(1.0, (ROWS, 1))
    return np.asarray(loud * np.exp(-np.arange(SAMPLES) / 30.0))


@pytest.mark.parametrize(
    ("more", "said"),
    [(0.0, False), (3.0 * carriers(6), True), (3.0 * carriers(2), True), (tail(), False)],
)
def test_carriers_are_told_from_noise(more: NDArray[np.complex128], said: bool) -> None:
    others = [np.abs(noise(seed)) for seed in range(11, 19)]
    assert carried(np.abs(noise(1) + more), others, QUIET) is said


def test_a_louder_noise_is_noise() -> None:
    others = [np.abs(noise(seed)) for seed in range(11, 19)]
    assert not carried(2.0 * np.abs(noise(1)), others, QUIET)


def test_of_few_distances_nothing_is_said() -> None:
    few = np.arange(SAMPLES) < 7
    assert not carried(np.abs(noise(1) + 3.0 * carriers(6)), [np.abs(noise(2))], few)
