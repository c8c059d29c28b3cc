"""Closed curves over the heading."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.bootstrap import latent_intervals
from bench.discrepancy.fit.headings import HEADINGS_DEG, curve_over, pattern_curve, smoothest
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.fitted.pattern_curve import PatternCurve, closed
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.simulator import Simulator

WORLD = Resimulation(Simulator(Base(), (TimestampJitter(jitter_samples=0.08),), 3), Window())
LINKS, ROWS = 60, 8


def _lobe(heading):
    """Return a narrow lobe of 8 cm around 40 degrees."""
    return 0.08 * np.exp(8 * (np.cos(heading - np.radians(40)) - 1))


def _view(shift, span_deg: float = 180.0) -> View:
    rng = np.random.default_rng(2)
    heading = rng.uniform(-span_deg, span_deg, LINKS * ROWS)
    frame = pd.DataFrame(
        {
            "link": np.repeat([f"l{i}" for i in range(LINKS)], ROWS),
            "true_range_m": np.repeat(rng.uniform(2, 20, LINKS), ROWS),
            "azimuth_deg": heading,
        }
    )
    frame["error_m"] = 0.024 * rng.normal(size=len(frame)) + shift(np.radians(heading))
    frame["range_m"] = frame["true_range_m"] + frame["error_m"]
    rows = np.arange(len(frame))
    return view(frame, link_codes(frame), rows, Window(), ("error_m",), False)


def test_a_lobe_is_followed_up_to_a_constant():
    found = pattern_curve(WORLD, _view(_lobe), ())
    assert found is not None
    at = np.radians(np.arange(-180, 180, 10.0))
    left = closed(at, found.headings_deg, found.bias_m) - _lobe(at)
    assert np.std(left) < 0.008
    assert abs(np.mean(left)) < 0.02


def test_a_constant_is_no_pattern():
    found = pattern_curve(WORLD, _view(lambda heading: 0.1), ())
    assert found is not None
    assert np.abs(found.bias_m).max() < 0.02


def test_no_pattern_without_a_circle_of_headings():
    assert pattern_curve(WORLD, _view(_lobe, span_deg=50), ()) is None


def test_the_curve_is_closed():
    bias = tuple(range(len(HEADINGS_DEG)))
    ends = closed(np.radians([-180.0, 180.0, 172.5]), HEADINGS_DEG, tuple(map(float, bias)))
    assert ends[0] == ends[1] == 0
    assert ends[2] == pytest.approx(11.5)


def test_noise_is_smoothed_more_than_a_lobe():
    rng = np.random.default_rng(0)
    heading, links = rng.uniform(-np.pi, np.pi, 400), np.arange(400) // 8
    noise = 0.024 * rng.normal(size=400)
    assert smoothest(heading, noise, links) > smoothest(heading, noise + 3 * _lobe(heading), links)
    assert np.std(curve_over(heading, noise, 1.0)) < np.std(curve_over(heading, noise, 0.03))


def test_intervals_hold_the_lobe():
    seen = _view(_lobe)
    found = pattern_curve(WORLD, seen, ())
    assert found is not None
    near = {p.name: p for p in latent_intervals(WORLD, seen, (), found)}["bias_m[45 deg]"]
    far = {p.name: p for p in latent_intervals(WORLD, seen, (), found)}["bias_m[-135 deg]"]
    assert near.low - far.high < _lobe(np.radians(45)) < near.high - far.low


def test_intervals_hold_where_few_links_tell_of_a_heading():
    held = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        seen = _view(lambda heading: 0 * heading)
        few = np.sort(rng.permutation(len(seen.frame))[:150])
        frame = seen.frame.iloc[few].reset_index(drop=True)
        frame["error_m"] = 0.01 * rng.standard_t(4, len(few))
        frame["range_m"] = frame["true_range_m"] + frame["error_m"]
        some = view(frame, link_codes(frame), np.arange(len(few)), Window(), ("error_m",), False)
        found = pattern_curve(WORLD, some, ())
        assert found is not None
        held += [p.low <= 0 <= p.high for p in latent_intervals(WORLD, some, (), found)]
    assert np.mean(held) > 0.87


def test_lengths_of_lists_must_match():
    with pytest.raises(BenchError, match="expected 2 values in bias_m"):
        PatternCurve((0.0, 90.0), (0.0,))


def test_levels_that_follow_the_heading_are_a_gain_of_the_pattern():
    for size_db in (3.0, 0.0):
        plain = _view(_lobe)
        level = WORLD.simulator.observe(plain.scene, 0, cir=False).rx_power_dbm
        assert level is not None
        rng = np.random.default_rng(5)
        heading = np.radians(plain.frame["azimuth_deg"])
        level = level + size_db * (np.cos(heading) - 1) + 0.3 * rng.normal(size=len(level))
        frame = plain.frame.assign(rx_power_dbm=level)
        names = ("error_m", "rx_power_dbm")
        rows = view(frame, plain.links, plain.rows, Window(), names, False)
        found = pattern_curve(WORLD, rows, ())
        assert found is not None
        assert bool(found.gain_db) == bool(size_db)
        if found.gain_db:
            at = np.radians(np.arange(-180, 180, 10.0))
            left = closed(at, found.headings_deg, found.gain_db) - size_db * (np.cos(at) - 1)
            assert np.abs(left).max() < 0.6
