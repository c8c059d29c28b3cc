"""The compiled loops against numpy's plain arithmetic."""

import numpy as np
import pandas as pd
import pytest

from bench.physics import loops
from bench.physics.base import Base
from bench.physics.filters import (
    coloured,
    convolved,
    echo_taps,
    filtered,
    lagrange,
    moving_average,
)
from bench.physics.pulse import HALF_WIDTH, shape, table
from bench.physics.sampling import sampled
from bench.physics.scene import scene

RNG = np.random.default_rng(3)


def complex_rows(n: int, width: int) -> np.ndarray:
    return (RNG.normal(size=(n, width)) + 1j * RNG.normal(size=(n, width))).astype(np.complex64)


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_paths_are_pulses_at_their_delays(run) -> None:
    place = np.array([[20.25, 31.5, 2.0, 70.0], [15.0, 25.75, 40.0, 30.0]], np.float32)
    gain = np.array([[1, 2j, 5, 5], [0, -1, 0.5, 1 + 1j]], np.complex64)
    made = np.zeros((2, 2 * 64), np.float32)
    run(loops.add_paths)(made, place, loops.parts(gain), table(2.5))
    time, energy = np.arange(64), table(2.5)[0, HALF_WIDTH]
    for row in range(2):
        expected = sum(
            gain[row, p] * shape(time - place[row, p], 2.5) * energy
            for p in range(4)
            if 4 < place[row, p] < 59  # those at the window's edge are left out
        )
        np.testing.assert_allclose(made.view(np.complex64)[row], expected, atol=2e-3)


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_tails_are_pulses_on_every_tap(run) -> None:
    taps, first = complex_rows(2, 30), np.array([5.5, -8.25], np.float32)
    made = np.zeros((2, 2 * 40), np.float32)
    run(loops.add_tail)(made, first - HALF_WIDTH, loops.parts(taps), table(2.5))
    for row in range(2):
        offset = np.arange(40)[:, None] - (first[row] + np.arange(30)[None, :])
        pulses = shape(offset, 2.5) * table(2.5)[0, HALF_WIDTH]
        expected = pulses @ taps[row]
        np.testing.assert_allclose(made.view(np.complex64)[row], expected, atol=5e-3)


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_magnitudes_and_their_sums(run) -> None:
    signal, noise = complex_rows(3, 20), complex_rows(3, 20)
    made, sums = np.empty((3, 20), np.float32), np.empty((3, 4))
    run(loops.magnitude_rows)(made, loops.parts(signal), loops.parts(noise), sums)
    whole, size = np.abs(signal + noise), np.abs(noise)
    np.testing.assert_allclose(made, whole, rtol=1e-5)
    expected = [(whole**2).sum(1), whole.max(1), size.sum(1), (size**2).sum(1)]
    np.testing.assert_allclose(sums, np.stack(expected, axis=1), rtol=1e-5)


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_the_first_edge_rises_at_half_its_peak(run) -> None:
    magnitude = np.array(
        [[0, 0, 1, 4, 8, 2, 9, 0], [0, 0, 1, 4, 8, 2, 9, 0], [6, 5, 0, 0, 0, 0, 0, 0]], np.float32
    )
    found = np.empty(3)
    run(loops.edge_rows)(
        found, magnitude, np.array([3.0, 99.0, 1.0]), np.zeros(3), np.zeros(3, int), 4, 0.5
    )
    np.testing.assert_allclose(found, [3.0, 5 + 2.5 / 7, 0.0])


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_starts_decay_from_tap_to_tap(run) -> None:
    made, starts = np.empty((2, 4), np.float32), np.array([[1.0, 0, 2, 0], [0, 1, 0, 0]])
    run(loops.decay_rows)(made, starts, np.array([0.5, 0.1]))
    np.testing.assert_allclose(made, [[1, 0.5, 2.25, 1.125], [0, 1, 0.1, 0.01]], rtol=1e-6)


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_crops_begin_where_they_are_told(run) -> None:
    values, made = np.arange(20, dtype=np.float32).reshape(2, 10), np.empty((2, 4), np.float32)
    run(loops.crop_rows)(made, values, np.array([0, 6]))
    np.testing.assert_array_equal(made, [[0, 1, 2, 3], [16, 17, 18, 19]])


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_filters_shift_and_weigh(run) -> None:
    values = complex_rows(3, 20)
    made = np.empty((3, 40), np.float32)
    lags, taps = np.array([-2, 0, 3]), np.array([1j, 2.0, -0.5 + 1j], np.complex64)
    run(loops.filter_rows)(made, loops.parts(values), lags, taps.real.copy(), taps.imag.copy())
    expected = 2 * values
    expected[:, :-2] += 1j * values[:, 2:]
    expected[:, 3:] += taps[2] * values[:, :-3]
    np.testing.assert_allclose(made.view(np.complex64), expected, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("run", [lambda loop: loop, loops.compiled], ids=["python", "compiled"])
def test_quantised_rows_are_whole_and_clipped(run) -> None:
    wave, noise = 50 * complex_rows(2, 10), complex_rows(2, 10)
    out = [np.empty((2, 20), np.float32) for _ in range(2)]
    given = loops.parts(wave), loops.parts(noise)
    run(loops.quantise_rows)(out[0], out[1], *given, np.float32(2), np.float32(60))
    whole = out[0] + out[1]
    np.testing.assert_array_equal(whole % 2, 0)
    assert np.abs(whole).max() <= 60
    free = np.abs(given[0]) < 55
    assert np.abs(whole - given[0] - given[1])[free].max() <= 2


def test_plain_and_compiled_images_agree() -> None:
    from bench.physics.images import floor_hits, orders

    image = orders(3)
    ends = np.column_stack([RNG.uniform(1, 2, (4, 6)), RNG.uniform(3, 5, (4, 3))])
    tables = RNG.normal(size=(3, 2 * 101)).astype(np.float32)
    results = []
    for loop in (loops.image_rows, loops.compiled(loops.image_rows)):
        length, factor = np.empty((4, len(image))), np.empty((4, 2 * len(image)), np.float32)
        loop(length, factor, ends, image, floor_hits(image[:, 2]), tables)
        results.append((length, factor))
    np.testing.assert_allclose(results[0][0], results[1][0])
    np.testing.assert_allclose(results[0][1], results[1][1], rtol=1e-4, atol=1e-4)


def test_fractional_delay_of_a_pulse_is_a_pulse_later() -> None:
    time = np.arange(40.0)
    pulse = shape(time - 15, 2.5)[None].astype(np.complex64)
    lags, taps = echo_taps(4.3, 0.5j)
    made = filtered(pulse, lags, taps)[0]
    expected = pulse[0] + 0.5j * shape(time - 19.3, 2.5)
    np.testing.assert_allclose(made, expected, atol=0.02)
    np.testing.assert_allclose(lagrange(np.array([0.0, 0.3, 0.9])).sum(axis=0), 1, atol=1e-6)


def test_convolution_keeps_the_centre() -> None:
    spike = np.zeros((1, 9), np.complex64)
    spike[0, 4] = 1
    np.testing.assert_allclose(convolved(spike, np.array([1.0, 2, 3]))[0, 3:6].real, [1, 2, 3])


def test_colour_is_the_wanted_autocorrelation() -> None:
    wanted = np.array([0.32, -0.17, -0.20])
    taps = moving_average(wanted)
    found = [np.sum(taps[lag:] * taps[: len(taps) - lag]) for lag in range(4)]
    np.testing.assert_allclose(found, [1, *wanted], atol=0.01)
    white = complex_rows(4000, 32)
    made = coloured(white, wanted)
    assert abs(np.mean(np.abs(made) ** 2) / np.mean(np.abs(white) ** 2) - 1) < 0.02
    first = np.mean(made[:, 1] * made[:, 0].conj()).real / np.mean(np.abs(made) ** 2)
    assert abs(first - 0.32) < 0.05  # at the row's beginning too


def test_delays_that_are_no_numbers_reach_no_sample() -> None:
    rows = scene(pd.DataFrame({"true_range_m": [3.0, 4.0, 5.0, 6.0]}))
    batch = Base().paths(rows).with_tail(complex_rows(4, 30), np.zeros(4))
    start = np.array([-20, np.nan, np.inf, -1e30], np.float32)
    made = sampled(batch, start, 64, 2.5)
    assert np.abs(made[0]).max() > 0
    assert not made[1:].any()
