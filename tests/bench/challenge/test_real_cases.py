"""The checks of the real cases, on small made-up recordings where the answer is known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.challenge.real.case import markdown_table
from bench.challenge.real.ghent_case import (
    clock_curves,
    leave_link_out,
    second_halves,
    stretches_out,
)
from bench.challenge.real.outdoor_case import (
    bounce_m,
    heights_out,
    nulls_db,
    positions,
    slope_at_fixed_distance,
)
from bench.challenge.real.two_ray import PERMITTIVITY, excess_m, gain_of_sum, reflected, shift_m
from bench.physics.effects.fitted.power_curve import LOGGED_DBM, TRUE_DBM
from bench.physics.effects.ranging.power_bias import published_bias_m
from bench.physics.units import C_M_PER_NS

WAVELENGTH_M = C_M_PER_NS / 6.4896
HEIGHTS_M = [0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.9]


def _heights(bias: bool = True, bounce: bool = False) -> pd.DataFrame:
    """Return rows at seven heights and 25 distances, level by two rays over ground."""
    rng = np.random.default_rng(0)
    height, far = (a.ravel() for a in np.meshgrid(HEIGHTS_M, np.arange(20.0, 70.0, 2.0)))
    one = np.ones_like(height)
    true = np.hypot(far, height - 1)
    amplitude = reflected(true, height, one, PERMITTIVITY, vertical=True)
    phase = -2 * np.pi * excess_m(true, height, one) / WAVELENGTH_M
    gain = np.abs(1 - amplitude * np.exp(1j * phase)) ** 2
    level = -53 - 20 * np.log10(true) + 10 * np.log10(gain)
    error = 0.2 + (published_bias_m(level) if bias else 0.0)
    error = error + bounce * shift_m(excess_m(true, height, one), amplitude, gain)
    frame = pd.DataFrame(
        {"link": [f"h{h}" for h in height], "tx_x_m": far, "tx_z_m": height, "rx_z_m": 1.0,
         "true_range_m": true, "rx_power_dbm": np.interp(level, TRUE_DBM, LOGGED_DBM)}
    )  # fmt: skip
    frame = frame.loc[frame.index.repeat(5)].reset_index(drop=True)
    frame["range_m"] = frame["true_range_m"] + np.repeat(error, 5) + rng.normal(0, 0.01, len(frame))
    return frame


def test_the_first_order_shift_is_that_of_two_pulses():
    excess, amplitude, pulse_m = 0.01, 0.6, 0.6
    grid = np.linspace(-3, 3, 200_001)
    for phase in np.linspace(0, 2 * np.pi, 9):
        ray = -amplitude * np.exp(1j * phase)
        whole = np.exp(-((grid / pulse_m) ** 2)) + ray * np.exp(-(((grid - excess) / pulse_m) ** 2))
        peak = grid[np.argmax(np.abs(whole))]
        gain = np.array([abs(1 + ray) ** 2])
        assert shift_m(np.array([excess]), np.array([amplitude]), gain)[0] == pytest.approx(
            peak, abs=2e-4
        )


def test_reflections_at_grazing_incidence_are_total_and_brewster_vanishes():
    far, high = np.array([1e5]), np.array([1.0])
    assert reflected(far, high, high, PERMITTIVITY, vertical=True)[0] == pytest.approx(1, abs=1e-3)
    flat = 2 * np.sqrt(PERMITTIVITY)  # tan(incidence) = sqrt(eps), both heights one metre
    near = np.array([flat])
    assert reflected(near, high, high, PERMITTIVITY, vertical=True)[0] < 1e-9
    assert reflected(near, high, high, PERMITTIVITY, vertical=False)[0] > 0.2


def test_the_gain_of_two_paths_is_found_from_levels():
    frame = _heights()
    places = positions(frame)
    amplitude = reflected(
        *(places[k].to_numpy() for k in ("distance", "height", "other")), PERMITTIVITY, True
    )
    level = np.interp(places["level"], LOGGED_DBM, TRUE_DBM)
    found = gain_of_sum(level, places["distance"].to_numpy(), amplitude)
    true = 10 ** ((level + 53 + 20 * np.log10(places["distance"])) / 10)
    assert np.median(np.abs(10 * np.log10(found / true))) < 1.0
    seen, possible = nulls_db(places, PERMITTIVITY, vertical=True)
    assert 3 < seen < possible + 1.5


def test_a_bias_of_level_is_told_from_none_at_fixed_distance():
    none = np.zeros(len(HEIGHTS_M) * 25)
    slope, p = slope_at_fixed_distance(positions(_heights()), none)
    assert slope < -0.002
    assert p < 0.01
    assert slope_at_fixed_distance(positions(_heights(bias=False)), none)[1] > 0.05


def test_modelling_the_bounce_takes_its_slope_away():
    places = positions(_heights(bias=False, bounce=True))
    raw = slope_at_fixed_distance(places, np.zeros(len(places)))[0]
    left = slope_at_fixed_distance(places, bounce_m(places, PERMITTIVITY, vertical=True))[0]
    assert raw > 0.001
    assert abs(left) < 0.4 * raw


def test_spread_falls_on_heights_left_out():
    error, by_level, by_distance = heights_out(_heights())
    assert by_level.std() < 0.6 * error.std()
    assert by_level.std() < by_distance.std()


def _crystals() -> tuple[pd.DataFrame, np.ndarray]:
    """Return single-sided errors of four pairs, two recordings each, and the true offsets."""
    rng = np.random.default_rng(1)
    nodes = {"1": 2.0, "2": -1.0, "3": -2.0, "4": 1.0}
    parts = []
    for number, (a, b) in enumerate([("1", "3"), ("1", "4"), ("2", "3"), ("2", "4")] * 2):
        a, b = (a, b) if number < 4 else (b, a)
        time = np.sort(rng.uniform(0, 200, 80)) + 1000 * number
        ppm = nodes[a] - nodes[b] + 0.002 * np.sin(time / 40)
        link = "-".join(sorted((a, b)))
        parts.append(pd.DataFrame({"link": link, "tx": a, "rx": b, "time_s": time, "ppm": ppm}))
    frame = pd.concat(parts, ignore_index=True).assign(true_range_m=10.0, reply_time_s=0.2)
    shift = frame["ppm"] * C_M_PER_NS * frame["reply_time_s"] / 2 * 1e3
    frame["error_m"] = shift + rng.normal(0, 0.03, len(frame))
    return frame.drop(columns="ppm"), frame["ppm"].to_numpy()


def test_crystals_are_followed_and_predicted_where_held_out():
    frame, truth = _crystals()
    curves = clock_curves(frame, truth)
    assert len(curves) > 40
    assert (curves["diagnosed_ppm"] - curves["double_sided_ppm"]).abs().max() < 0.01
    links = leave_link_out(frame, truth)
    assert len(links) == 4
    assert links["range_mae_m"].max() < 0.5
    assert links["before_mae_m"].min() > 25
    for range_m, ppm in (stretches_out(frame, truth), second_halves(frame, truth)):
        assert range_m < 0.15
        assert ppm < 0.02


def test_tables_are_markdown():
    lines = markdown_table(pd.DataFrame({"a": [1.23456], "b": ["x"]}))
    assert lines == ["| a | b |", "| --- | --- |", "| 1.235 | x |"]
