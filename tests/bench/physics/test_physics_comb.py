"""Rounding leaves a grid in the ranges; scatter, offsets and places on a grid leave none."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.comb import comb
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.units import Floats

RNG = np.random.default_rng(3)
TRUE_M = np.repeat(RNG.uniform(3, 28, 80), 3)
LINKS = np.repeat(np.arange(80), 3)


def noisy(scatter_m: float = 0.025) -> Floats:
    return TRUE_M + np.random.default_rng(5).normal(0, scatter_m, len(TRUE_M))


def rounded(values: Floats, step: float, origin: float = 0.0) -> Floats:
    return np.rint((values - origin) / step) * step + origin


@pytest.mark.parametrize(("step", "origin"), [(0.05, 0.0), (0.1, 0.05), (0.2, 0.03), (0.5, 0.1)])
def test_a_grid_is_found_with_its_step_and_origin(step: float, origin: float) -> None:
    found = comb(rounded(noisy(), step, origin), TRUE_M, LINKS)
    assert found is not None
    assert found.step_m == pytest.approx(step, rel=1e-4)
    assert (found.origin_m - origin) / step % 1 == pytest.approx(0, abs=0.01) or (
        (found.origin_m - origin) / step % 1 == pytest.approx(1, abs=0.01)
    )


@pytest.mark.parametrize("scatter_m", [0.02, 0.06, 0.15])
def test_scatter_leaves_no_grid(scatter_m: float) -> None:
    assert comb(noisy(scatter_m), TRUE_M, LINKS) is None


def test_offsets_of_few_links_are_no_grid() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        links = np.repeat(np.arange(6), 40)
        true = rng.uniform(2, 20, 6)[links]
        off = rng.normal(0, 0.2, 6)[links] + rng.normal(0, 0.02, len(links))
        assert comb(true + off, true, links) is None


def test_places_on_a_grid_are_no_rounding() -> None:
    true = rounded(TRUE_M, 0.5)
    assert comb(true + np.random.default_rng(1).normal(0, 0.02, len(true)), true, LINKS) is None


def frame(measured_m: Floats) -> pd.DataFrame:
    return pd.DataFrame({"range_m": measured_m, "true_range_m": TRUE_M, "link": LINKS})


def test_the_effect_finds_whether_it_cuts_down_and_comes_first() -> None:
    cut = np.floor(noisy() / 0.1) * 0.1
    made = RangeRounding.fit_values(frame(cut), cut - TRUE_M)
    assert isinstance(made, RangeRounding)
    assert (made.lean, made.early, made.last) == (-0.5, 0, True)
    shift = np.random.default_rng(2).normal(0, 0.3, 80)[LINKS]
    late = rounded(noisy(), 0.1) + shift
    made = RangeRounding.fit_values(frame(late), late - TRUE_M - shift)
    assert isinstance(made, RangeRounding)
    assert (made.lean, made.early, made.first) == (0.0, 1, True)
    assert made.values()["step_m"] == pytest.approx(0.1, rel=1e-4)


def test_the_effect_is_not_offered_for_scatter() -> None:
    assert RangeRounding.fit_values(frame(noisy(0.08)), noisy(0.08) - TRUE_M) is None


def test_a_bit_that_is_stuck_is_no_rounding() -> None:
    """Bit 4 of a centimetre register is always set: half of every 32 cm is never reported."""
    register = np.rint(noisy(0.03) / 0.01).astype(np.int64) | 16
    stuck = register * 0.01 + np.random.default_rng(4).uniform(-0.005, 0.005, len(register))
    made = RangeRounding.fit_values(frame(stuck), stuck - TRUE_M)
    assert made is None


def test_ranges_of_few_links_that_drift_by_less_than_a_step_show_no_grid() -> None:
    """Single-sided ranges of four links, either way round, each off by its clocks: SIMULATED."""
    rng = np.random.default_rng(5)
    for seed in range(20):
        middle = np.random.default_rng(seed).uniform(-140, 150, (4, 2))
        drift = 0.1 * rng.random((4, 2, 1)) * np.linspace(-1, 1, 400)
        measured = (middle[..., None] + drift + 0.03 * rng.normal(size=(4, 2, 400))).ravel()
        links = np.repeat(np.arange(4), 800)
        assert comb(measured, np.repeat(np.linspace(3, 20, 4), 800), links) is None
