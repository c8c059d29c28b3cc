"""Values per device and level from residual ranges: antenna delays, the bias over level."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.bootstrap import latent_values
from bench.discrepancy.fit.per_device import (
    device_delay,
    device_terms,
    fewest_off,
    latent_effects,
    power_curve,
)
from bench.physics.base import Base
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.fitted.power_curve import (
    LOGGED_DBM,
    TRUE_DBM,
    PowerCurve,
    true_level_dbm,
)
from bench.physics.effects.ranging.power_bias import published_bias_m
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS

WORLD = Resimulation(Simulator(Base()), Window())
DELAYS_NS = {"a": 0.6, "b": -0.4, "c": 0.1, "d": 0.3}


def _view(frame: pd.DataFrame) -> View:
    return view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("error_m",), False)


def _pairs() -> pd.DataFrame:
    """Return rows of every pair of four devices with their antenna delays."""
    rng = np.random.default_rng(0)
    names = [(x, y) for x in DELAYS_NS for y in DELAYS_NS if x != y]
    tx, rx = (np.repeat(side, 20) for side in zip(*names, strict=True))
    delay = np.array([DELAYS_NS[x] + DELAYS_NS[y] for x, y in zip(tx, rx, strict=True)])
    error = delay * C_M_PER_NS / 2 + rng.normal(0, 0.02, len(tx))
    return pd.DataFrame(
        {"link": [f"{x}{y}" for x, y in zip(tx, rx, strict=True)], "tx": tx, "rx": rx,
         "true_range_m": rng.uniform(3, 30, len(tx)), "error_m": error}
    )  # fmt: skip


def test_antenna_delays_are_found_per_device():
    seen = _view(_pairs())
    found = device_delay(seen, seen.recorded.column("error_m"))
    assert found is not None
    assert dict(zip(found.devices, found.delays_ns, strict=True)) == pytest.approx(
        DELAYS_NS, abs=0.05
    )


def test_values_of_some_devices_are_estimated_from_rows_of_more() -> None:
    """A device all of whose links were struck has rows, but no delay."""
    seen = _view(_pairs())
    few = DeviceDelay(devices=("a", "b", "d"), delays_ns=(0.6, -0.4, 0.3))
    found = latent_values(seen, few)
    assert found is not None
    names, _, values = found
    made = values(np.arange(len(seen.rows)), seen.recorded.column("error_m"), True)
    assert names == ("delay_ns[a]", "delay_ns[b]", "delay_ns[d]")
    assert made == pytest.approx([0.6, -0.4, 0.3], abs=0.2)


def test_metres_are_not_a_delay():
    frame = _pairs()
    seen = _view(frame.assign(error_m=frame["error_m"] + 30))
    assert device_delay(seen, seen.recorded.column("error_m")) is None


def test_terms_need_device_names_and_clocks_a_reply_time():
    frame = _pairs()
    assert device_terms(WORLD, _view(frame.drop(columns=["tx", "rx"])), ()) == []
    kinds = [type(effect) for effect in latent_effects(WORLD, _view(frame), ())]
    assert kinds == [DeviceDelay]


def _levels() -> pd.DataFrame:
    """Return rows over distance whose error is the published bias at the true level."""
    rng = np.random.default_rng(1)
    link = np.repeat(np.arange(40), 10)
    distance = np.linspace(2, 60, 40)[link]
    level = -55 - 20 * np.log10(distance) + rng.normal(0, 2, 40)[link]
    error = 0.2 + published_bias_m(level) + rng.normal(0, 0.01, len(link))
    return pd.DataFrame(
        {"link": [f"l{i}" for i in link], "true_range_m": distance, "rx_power_dbm": level,
         "error_m": error}
    )  # fmt: skip


def test_the_bias_curve_follows_the_published_one():
    frame = _levels()
    seen = _view(frame)
    curve = power_curve(WORLD, seen, ())
    assert isinstance(curve, PowerCurve)
    guess = np.interp(curve.level_dbm(seen.scene), curve.levels_dbm, curve.bias_m)
    assert np.std(frame["error_m"] - guess) < 0.4 * frame["error_m"].std()
    middle = np.array([-88.0, -84.0])
    step = np.diff(np.interp(middle, curve.levels_dbm, curve.bias_m))
    assert step == pytest.approx(np.diff(published_bias_m(middle)), abs=0.02)


def test_the_levels_of_a_receiver_that_logs_what_arrives_are_taken_as_they_are() -> None:
    frame = _levels()
    frame["error_m"] = 0.1 * np.tanh((-75.0 - frame["rx_power_dbm"]) / 5)
    curve = power_curve(WORLD, _view(frame), ())
    assert curve is not None
    assert curve.compression == 0
    told = dict(zip(curve.levels_dbm, curve.values().items(), strict=True))
    for level in (-82.0, -73.0, -70.0):
        name, bias_m = told[level]
        assert name == f"bias_m[{level:g} dBm]"
        assert bias_m == pytest.approx(0.1 * np.tanh((-75.0 - level) / 5), abs=0.012)
    pressed = np.interp(frame["rx_power_dbm"], TRUE_DBM, LOGGED_DBM)
    curve = power_curve(WORLD, _view(frame.assign(rx_power_dbm=pressed)), ())
    assert curve is not None
    assert curve.compression == 1


def test_no_curve_without_logged_levels():
    frame = _levels()
    assert power_curve(WORLD, _view(frame.drop(columns="rx_power_dbm")), ()) is None
    assert power_curve(WORLD, _view(frame.assign(rx_power_dbm=-70.0)), ()) is None


def test_a_compressed_level_is_decompressed_by_the_budget():
    logged, budget = np.array([-85.0, -78.5, np.nan]), np.array([-83.0, -65.0, -90.0])
    level = true_level_dbm(logged, budget, 3.0)
    assert level[0] == pytest.approx(-83.5, abs=0.5)
    assert -70 < level[1] < -62
    assert level[2] == pytest.approx(-90.0, abs=0.1)


def test_of_delays_with_the_same_sums_most_are_near_zero() -> None:
    tag, anchors = 0, np.arange(1, 6)
    tx, rx = np.full(5, tag), anchors
    found = fewest_off(np.array([0.25, -0.25, -0.25, 1.45, -0.25, -0.25]), tx, rx)
    np.testing.assert_allclose(found, [0, 0, 0, 1.7, 0, 0], atol=1e-12)
    ring = np.array([0, 1, 2]), np.array([1, 2, 0])  # every device both ways: nothing is free
    np.testing.assert_allclose(fewest_off(np.array([0.1, 0.2, 0.3]), *ring), [0.1, 0.2, 0.3])
