"""Observables: right numbers from hand-made CIRs, NaN where nothing is known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.data.observables import Window, observe, shared_window, window_of
from bench.physics.base import Base
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.scene import scene
from bench.physics.simulator import Simulator


def _frame(cirs, first=8.0):
    return pd.DataFrame(
        {
            "cir": [np.asarray(c, np.float32) for c in cirs],
            "first_path_index": first,
            "sample_period_ns": 1.0,
            "noise_std": 0.01,
            "error_m": 0.1,
        }
    )


def test_two_taps_give_their_delay_spread_and_bins():
    cir = np.zeros(100)
    cir[8], cir[28] = 1.0, 1.0  # equal taps at 0 and 20 ns after the first path
    seen = observe(_frame([cir]))
    assert seen.column("mean_excess_delay_ns")[0] == pytest.approx(10)
    assert seen.column("rms_delay_spread_ns")[0] == pytest.approx(10)
    assert seen.column("rise_time_ns")[0] == pytest.approx(0)
    assert seen.column("first_path_lead_ns")[0] == pytest.approx(0)
    late = seen.column("profile_db[15.5..22.5ns]")[0]
    assert late == pytest.approx(10 * np.log10(1 / 7 / 2), abs=1e-6)
    assert np.isnan(seen.column("profile_db[32.5..45.5ns]")[0])  # no power at all: unknown in dB


def test_energy_before_the_detected_path_is_a_lead():
    cir = np.zeros(60)
    cir[4], cir[8] = 0.2, 1.0
    assert observe(_frame([cir])).column("first_path_lead_ns")[0] == pytest.approx(4)


def test_no_cir_no_cir_observables_and_infinities_are_unknown():
    frame = pd.DataFrame(
        {"range_m": [5.1, 5.2], "true_range_m": [5.0, 5.0], "rx_power_dbm": [-np.inf, -80.0]}
    )
    seen = observe(frame)
    assert seen.names == ("error_m", "rx_power_dbm")
    assert seen.column("error_m") == pytest.approx([0.1, 0.2])
    assert np.isnan(seen.column("rx_power_dbm")[0])


def test_rows_of_different_lengths_and_positions_are_aligned():
    short, long = np.full(50, 0.1), np.full(90, 0.1)
    short[8], long[30] = 1, 1
    frame = _frame([short, long]).assign(first_path_index=[8.0, 30.0])
    seen = observe(frame, Window(8, 40))
    assert seen.column("mean_excess_delay_ns")[0] == pytest.approx(
        seen.column("mean_excess_delay_ns")[1]
    )
    assert window_of(frame).before == 8


def test_staged_simulation_gives_the_numbers_of_the_simulator():
    frame = pd.DataFrame({"true_range_m": np.linspace(2, 9, 30), "reply_time_s": 4e-4})
    base = Base(cir_lead=8, cir_samples=118)
    simulator = Simulator(base, (ClockOffset(offset_ppm=2.0),), 5)
    window = Window(8, 110)
    rows = scene(frame)
    stages = Stages(window)
    staged = [stages.observables(simulator, rows, 3, True) for _ in range(2)][1]  # from memory
    direct = observe(simulator.simulate(frame, 5, 3).frame, window).keep(staged.names)
    assert np.allclose(staged.values, direct.values, rtol=1e-4, atol=1e-4, equal_nan=True)


def test_samples_are_compared_by_symbol_only_where_both_tables_tell_how_many():
    rng = np.random.default_rng(3)
    cirs = list(np.abs(rng.normal(size=(4, 60))))
    bare = pd.DataFrame({"cir": cirs, "first_path_index": 20.0, "true_range_m": 3.0})
    told = bare.assign(preamble_count=1024.0)
    assert shared_window(told, told).counted
    assert shared_window(told, None).counted
    for one, two in ((told, bare), (bare, told), (bare, bare)):
        window = shared_window(one, two)
        assert not window.counted
        ours, theirs = (observe(frame, window).column("energy_db") for frame in (one, two))
        assert ours == pytest.approx(theirs)
    assert shared_window(told, told[["true_range_m"]]).counted  # no samples there to compare
