"""The compiled figures of a CIR's shape are those of their definitions."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.data.cir_features import (
    COLUMNS,
    compiled,
    crossings,
    cut,
    early,
    moments,
    powers,
    profile,
    shape_figures,
)

EDGES = (-4.0, 1.0, 6.0, 40.0)
LEVELS = (0.6, 6.0, 5.0)


def _cirs(rows: int = 12, samples: int = 60) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    magnitude = np.abs(rng.normal(0, 1, (rows, samples)))
    magnitude[:, 9:13] += 60.0
    delay = np.arange(samples) - 9 + rng.uniform(0, 1, (rows, 1))
    return magnitude, delay, np.full(rows, 1.0)


def test_figures_follow_their_definitions():
    magnitude, delay, noise = _cirs()
    found, bins = shape_figures(magnitude, delay, noise, EDGES, LEVELS)
    power = magnitude**2
    total = power.sum(axis=1)
    mean_delay = (power * delay).sum(axis=1) / total
    spread = np.sqrt((power * (delay - mean_delay[:, None]) ** 2).sum(axis=1) / total)
    centred = magnitude - magnitude.mean(axis=1, keepdims=True)
    kurtosis = (centred**4).mean(axis=1) / (centred**2).mean(axis=1) ** 2
    assert found["total"] == pytest.approx(total)
    assert found["peak"] == pytest.approx(magnitude.max(axis=1))
    assert found["excess"] == pytest.approx(mean_delay)
    assert found["spread"] == pytest.approx(spread)
    assert found["kurtosis"] == pytest.approx(kurtosis)
    assert found["rise"] == pytest.approx(0.0)  # both levels are passed in the same sample
    assert found["lead"] == pytest.approx(-delay[:, 9])
    middle = (delay >= 1.0) & (delay < 6.0)
    assert bins[:, 1] == pytest.approx((power * middle).sum(axis=1) / middle.sum(axis=1))


def test_before_the_path_noise_scatters_as_rayleigh_says_and_a_tone_does_not():
    rng = np.random.default_rng(1)
    noise = rng.normal(size=(400, 40)) + 1j * rng.normal(size=(400, 40))
    delay = np.broadcast_to(np.arange(40.0) - 30, (400, 40)).copy()
    alike = [_early(np.abs(one), delay) for one in (noise, 7 * noise, noise + 3.0)]
    assert alike[0].mean() == pytest.approx(np.sqrt(4 / np.pi - 1), abs=0.02)
    assert alike[1] == pytest.approx(alike[0])
    assert alike[2].mean() < 0.35
    few = _early(np.abs(noise[:, 24:]), delay[:, 24:])  # three samples before -3.5 ns
    assert np.isnan(few).all()


def _early(magnitude: np.ndarray, delay: np.ndarray) -> np.ndarray:
    found, _ = shape_figures(magnitude, delay, np.ones(len(delay)), EDGES, LEVELS)
    return found["early"]


def test_what_is_not_known_takes_no_part():
    magnitude, delay, noise = _cirs()
    whole, _ = shape_figures(magnitude[:, :50], delay[:, :50], noise, EDGES, LEVELS)
    magnitude[:, 50:] = np.nan
    noise[3] = np.nan
    part, bins = shape_figures(magnitude, delay, noise, EDGES, LEVELS)
    for name in ("total", "peak", "excess", "spread", "kurtosis"):
        assert part[name] == pytest.approx(whole[name])
    assert np.isnan(part["lead"][3])
    magnitude[5] = np.nan
    empty, bins = shape_figures(magnitude, delay, noise, EDGES, LEVELS)
    assert empty["total"][5] == 0
    assert np.isnan(empty["kurtosis"][5])
    assert np.isnan(bins[5]).all()


def test_the_compiled_loop_is_the_written_one():
    magnitude, delay, noise = _cirs(4)
    out, bins = np.full((4, len(COLUMNS)), np.nan), np.empty((4, len(EDGES) - 1))
    powers(magnitude, delay, out)
    profile(magnitude, delay, np.array(EDGES), out, bins)
    moments(magnitude, delay, out)
    crossings(magnitude, delay, noise, np.array(LEVELS), out)
    early(magnitude, delay, -3.5, out)
    figures, fast = shape_figures(magnitude, delay, noise, EDGES, LEVELS)
    assert np.stack(list(figures.values()), axis=1) == pytest.approx(out)
    assert fast == pytest.approx(bins)


def test_a_bin_is_found_whatever_way_delays_run():
    magnitude, delay, noise = _cirs(3)
    _, forward = shape_figures(magnitude, delay, noise, EDGES, LEVELS)
    turned = (np.ascontiguousarray(each[:, ::-1]) for each in (magnitude, delay))
    _, backward = shape_figures(*turned, noise, EDGES, LEVELS)
    assert backward == pytest.approx(forward)


def test_a_cut_reaches_from_before_the_first_path_and_leaves_the_rest_unknown():
    cir = np.arange(30.0).reshape(3, 10)
    first, period = np.array([2.5, np.nan, 8.0]), np.array([1.0, 1.0, 2.0])
    for run in (cut, compiled(cut)):
        made, delay = np.empty((3, 5)), np.empty((3, 5))
        run(cir, first, period, 3, made, delay)
        nan = np.nan
        assert made[0] == pytest.approx([nan, 0, 1, 2, 3], nan_ok=True)
        assert np.isnan(made[1]).all()
        assert made[2] == pytest.approx([25, 26, 27, 28, 29])
        assert delay[0] == pytest.approx(np.arange(-1, 4) - 2.5)
        assert delay[2] == pytest.approx(np.arange(-3, 2) * 2.0)
