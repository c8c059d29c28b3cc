"""Clocks per device: constant, drifting or wandering, whichever predicts what was left out."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.clocks import STEADY, device_clock, polynomial
from bench.discrepancy.fit.heard import Heard
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.wander import bridge
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.toml_file import from_toml, to_toml
from bench.physics.units import C_M_PER_NS

DEVICES = 4
REPLY_S = 0.05


def _frame(curves, seed: int = 0, noise_m: float = 0.03) -> tuple[pd.DataFrame, np.ndarray]:
    """Return rows of every pair over two hours and the true offset of each in ppm."""
    rng = np.random.default_rng(seed)
    pairs = [(a, b) for a in range(DEVICES) for b in range(DEVICES) if a != b]
    parts = []
    for number, (a, b) in enumerate(pairs):
        time = np.sort(rng.uniform(0, 7200, 60))
        ppm = curves(a, time) - curves(b, time)
        error = ppm * C_M_PER_NS * REPLY_S / 2 * 1e3 + rng.normal(0, noise_m, 60)
        parts.append(
            pd.DataFrame(
                {"link": f"l{number}", "tx": f"n{a}", "rx": f"n{b}", "time_s": time, "ppm": ppm,
                 "true_range_m": 10.0, "reply_time_s": REPLY_S, "error_m": error}
            )
        )  # fmt: skip
    frame = pd.concat(parts, ignore_index=True)
    return frame.drop(columns="ppm"), frame["ppm"].to_numpy()


def _view(frame: pd.DataFrame) -> View:
    return view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("error_m",), False)


def _fit(frame: pd.DataFrame) -> DeviceClock:
    seen = _view(frame)
    return device_clock(seen, seen.recorded.column("error_m"))


def _waves(device: int, time: np.ndarray) -> np.ndarray:
    return device - 1.5 + 0.3 * np.sin(2 * np.pi * time / 3000 + device)


def test_constant_crystals_get_no_curve():
    frame, truth = _frame(lambda device, time: np.full(len(time), device - 1.5))
    clock = _fit(frame)
    assert clock.knots_s == ()
    assert not any(clock.drifts_ppm_per_hour)
    assert np.abs(clock.offset_ppm(_view(frame).scene) - truth).max() < 0.01


def test_drifting_crystals_get_drifts():
    frame, truth = _frame(lambda device, time: device + 0.4 * (device - 1.5) * time / 3600)
    clock = _fit(frame)
    assert clock.knots_s == ()
    assert np.ptp(clock.drifts_ppm_per_hour) == pytest.approx(1.2, abs=0.05)
    assert np.abs(clock.offset_ppm(_view(frame).scene) - truth).max() < 0.01


def test_crystals_that_follow_their_temperature_get_slopes_of_their_own():
    frame, _ = _frame(lambda device, time: np.zeros(len(time)))
    warm = 20 + 8 * np.sin(2 * np.pi * np.arange(len(frame)) / 37)
    tx, rx = (frame[end].str[1:].astype(int).to_numpy() for end in ("tx", "rx"))
    truth = 1.0 * (tx - rx) + 0.05 * (tx - rx) * (warm - 20)
    longer = truth * C_M_PER_NS * REPLY_S / 2 * 1e3
    frame = frame.assign(temperature_c=warm, error_m=frame["error_m"] + longer)
    clock = _fit(frame)
    assert clock.knots_s == ()
    assert np.ptp(clock.slopes_ppm_per_c) == pytest.approx(0.15, abs=0.01)
    assert np.abs(clock.offset_ppm(_view(frame).scene) - truth).max() < 0.01
    simulator = Simulator(Base(), (clock,), 0)
    assert from_toml(to_toml(simulator)) == simulator


def test_wandering_crystals_are_followed_and_held_out_rows_predicted():
    frame, truth = _frame(_waves)
    held = (np.arange(len(frame)) // 10 + np.arange(len(frame)) // 60) % 3 == 0
    clock = _fit(frame[~held].reset_index(drop=True))
    assert all(1 < len(knots) <= 32 for knots in clock.knots_s)
    offset = clock.offset_ppm(_view(frame[held].reset_index(drop=True)).scene)
    assert np.abs(offset - truth[held]).mean() < 0.02
    constant = pd.Series(truth).groupby(frame["link"]).transform("mean").to_numpy()
    assert np.abs(offset - truth[held]).mean() < 0.1 * np.abs(constant - truth)[held].mean()


def test_few_wild_rows_do_not_bend_the_curve():
    frame, truth = _frame(_waves)
    frame.loc[::40, "error_m"] += 30.0
    offset = _fit(frame).offset_ppm(_view(frame).scene)
    assert np.abs(offset - truth).mean() < 0.02


def test_rows_without_time_keep_constant_offsets():
    frame, _ = _frame(_waves)
    assert _fit(frame.drop(columns="time_s")).knots_s == ()


def test_a_wandering_clock_round_trips_and_scatters_where_it_is_not_known():
    frame, _ = _frame(_waves)
    early = frame[frame["time_s"] < 3000].reset_index(drop=True)
    clock = _fit(early)
    simulator = Simulator(Base(), (clock,))
    assert from_toml(to_toml(simulator)) == simulator
    late = frame.assign(time_s=frame["time_s"] + 86400)
    known, unknown = (clock.uncertainty_ppm(_view(rows).scene) for rows in (early, late))
    assert known.max() == 0.0
    assert unknown.min() > 0.5 * clock.spread_ppm
    spread = [_scatter(simulator, rows) for rows in (early, late)]
    assert spread[0] == 0.0
    assert spread[1] > 0.5 * clock.spread_ppm


def _scatter(simulator: Simulator, frame: pd.DataFrame) -> float:
    """Return the std over replicates of the simulated clock offset, in ppm, first row.

    Exactly 0 where all are the same: a mean of equal numbers may round, their range does not.
    """
    rows = scene(frame.iloc[:8])
    made = [simulator.observe(rows, number, cir=False).clock_offset_ppm[0] for number in range(30)]
    return float(np.std(made)) if np.ptp(made) > 0 else 0.0


def test_swapped_roles_change_the_sign_of_what_is_not_known():
    clock = _fit(_frame(_waves)[0])
    rows = pd.DataFrame(
        {"link": "l", "tx": ["n0", "n1"], "rx": ["n1", "n0"], "time_s": 1e5,
         "true_range_m": 5.0, "reply_time_s": 1e-3}
    )  # fmt: skip
    made = Simulator(Base(), (clock,)).observe(scene(rows), 3, cir=False).clock_offset_ppm
    assert made[0] == pytest.approx(-made[1])


def test_bridge_is_the_conditional_normal():
    knots, time, settle = np.array([0.0, 5.0, 7.0]), np.array([-2.0, 1.0, 5.0, 6.5, 30.0]), 4.0
    values = np.array([1.0, -2.0, 0.5])
    mean, variance = bridge(time, knots, values, settle)
    kernel = lambda a, b: np.exp(-np.abs(a[:, None] - b) / settle)  # noqa: E731
    gain = np.linalg.solve(kernel(knots, knots), kernel(knots, time)).T
    assert mean == pytest.approx(gain @ values)
    assert variance == pytest.approx(1 - np.sum(gain * kernel(time, knots), axis=1), abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"knots_s": ((0.0,),)}, "as many"),
        ({"knots_s": ((0.0,), (1.0,)), "wander_ppm": ((0.0,), ())}, "as many"),
        ({"knots_s": ((1.0, 0.0), ()), "wander_ppm": ((0.0, 0.0), ())}, "increase"),
    ],
)
def test_wrong_curves_are_refused(changes, words):
    with pytest.raises(BenchError, match=words):
        DeviceClock(("a", "b"), (0.0, 0.0), (0.0, 0.0), **changes)


def test_reply_times_in_another_unit_are_fitted_or_one_line():
    frame, _ = _frame(_waves)
    frame["reply_time_s"] *= 1e6
    assert np.isfinite(_fit(frame).offsets_ppm).all()


def _asked(swapped: bool, late_m: float) -> tuple[pd.DataFrame, np.ndarray]:
    """Return rows of two tags that ask anchors, and if `swapped` each other, all `late_m` long."""
    rng = np.random.default_rng(3)
    pairs = [(tag, anchor) for tag in (0, 1) for anchor in (2, 3)] + [(0, 1), (1, 0)] * swapped
    tx, rx = np.repeat(pairs, 50, axis=0).T
    ppm = np.array([2.0, 1.0, -1.0, -2.0])[tx] - np.array([2.0, 1.0, -1.0, -2.0])[rx]
    error = late_m + ppm * C_M_PER_NS * 3e-4 / 2 * 1e3 + rng.normal(0, 0.03, len(tx))
    link = [f"{a}-{b}" for a, b in zip(tx, rx, strict=True)]
    frame = pd.DataFrame({"link": link, "tx": [f"n{a}" for a in tx], "rx": [f"n{b}" for b in rx]})
    return frame.assign(true_range_m=10.0, reply_time_s=3e-4, error_m=error), ppm


def test_a_constant_of_all_ranges_is_no_clock_where_roles_are_swapped():
    frame, truth = _asked(swapped=True, late_m=0.3)
    assert np.abs(_fit(frame).offset_ppm(scene(frame)) - truth).max() < 0.5


def test_where_tags_alone_ask_a_constant_may_be_their_clocks():
    frame, truth = _asked(swapped=False, late_m=0.0)
    assert np.abs(_fit(frame).offset_ppm(scene(frame)) - truth).max() < 0.5


def test_forms_of_clocks_are_compared_without_a_constant():
    """Of crystals that wander from pair to pair it would take what they have in common."""
    for swapped in (True, False):
        frame, truth = _asked(swapped, late_m=0.3)
        seen = _view(frame)
        heard = Heard.of(seen, seen.recorded.column("error_m"))
        assert heard.with_mean == swapped
        every = np.arange(len(frame))
        plain, beside = (polynomial(heard, every, STEADY, one) for one in (False, heard.with_mean))
        off = [np.abs(one.offset_ppm(seen.scene) - truth).max() for one in (plain, beside)]
        assert off[0] > 2.0
        assert (off[1] < 0.5) == swapped
