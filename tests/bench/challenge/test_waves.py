"""Effects hidden in the waveform: each moves what it should, and nothing tells the answer."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.blind import seal
from bench.challenge.generator.waveforms import (
    WAVES,
    WAVES_OUTSIDE,
    HiddenWave,
    conceal_wave,
    draw_wave,
    recorded,
)
from bench.challenge.waves import make_wave, wide_table
from bench.discrepancy.data.observables import observe

MOVED = {
    "diffuse-tail": ("profile_db[22.5..32.5ns]", 1),
    "pulse-ringing": ("profile_db[6.5..10.5ns]", 1),
    "narrowband-interference": ("noise_std", 1),
    "noise-floor": ("noise_std", 1),
    "path-loss": ("rx_power_dbm", -1),
    "level-control": ("preamble_count", -1),
    "pre-echo": ("rise_time_ns", 1),
    "warm-gain": ("rx_power_dbm", 0),
}

RING = "pulse-ringing"


@pytest.fixture(scope="module")
def clean():
    return wide_table(0, 5)[0]


@pytest.mark.parametrize("name", sorted(WAVES))
def test_every_wave_moves_its_observable(clean, name):
    column, sign = MOVED[name]
    before, out = recorded(clean), recorded(conceal_wave(clean, HiddenWave(name, 0.3), 3))
    moved = observe(out).column(column) - observe(before).column(column)
    if sign:
        assert np.nanmean(moved) * sign > 0
    else:
        warm = clean["temperature_c"].to_numpy() > 25
        assert np.nanmean(moved[warm]) < np.nanmean(moved[~warm])
    assert np.allclose(out["range_m"] - out["true_range_m"], out["error_m"])


@pytest.mark.parametrize("name", ["noise-floor", "narrowband-interference"])
def test_noise_reported_is_the_noise_in_the_samples(clean, name):
    out = recorded(conceal_wave(clean, HiddenWave(name, 0.3), 3))
    late = np.stack(list(out["cir"]))[:, 80:]
    assert late.std(axis=1).mean() == pytest.approx(out["noise_std"].mean(), rel=0.15)


def test_a_tone_is_one_line_and_noise_is_none(clean):
    def peaked(name: str) -> float:
        out = conceal_wave(clean, HiddenWave(name, 0.3), 3)
        late = np.stack(list(out["cir_i"])) + 1j * np.stack(list(out["cir_q"]))
        power = (np.abs(np.fft.fft(late[:, 100:], axis=1)) ** 2).mean(axis=0)
        return float(power.max() / np.median(power))

    assert peaked("narrowband-interference") > 10
    assert peaked("noise-floor") < 3


def test_what_rings_on_is_missing_from_the_pulse(clean):
    before, out = (recorded(t) for t in (clean, conceal_wave(clean, HiddenWave(RING, 0.3), 3)))
    assert np.allclose(out["rx_power_dbm"], before["rx_power_dbm"], atol=0.1)
    assert np.mean(out["first_path_power_dbm"] - before["first_path_power_dbm"]) < -0.2


def test_a_case_without_an_effect_is_the_simulators_own(clean):
    case = make_wave(0, 5)
    clean = recorded(clean)
    assert case.hidden.names == ()
    assert case.strength_z == 0
    assert np.array_equal(np.stack(case.recorded.frame["cir"]), np.stack(clean["cir"]))


def test_strength_is_counted_in_standard_errors():
    number = next(n for n in range(1, 20) if draw_wave(n, 5).name == "noise-floor")
    assert make_wave(number, 5).strength_z > 3


def test_shares_of_empty_and_outside_cases_and_their_seal():
    drawn = [draw_wave(number, 1) for number in range(40)]
    assert sum(one.name is None for one in drawn) == 10
    assert sum(one.name in WAVES_OUTSIDE for one in drawn) == 6
    assert seal(4, 1, 3) != seal(4, 1, 4)
