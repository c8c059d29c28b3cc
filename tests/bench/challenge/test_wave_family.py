"""Effects hidden in another simulator's waveforms: each moves what it should."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.challenge.cases import make_case
from bench.challenge.families.case import Draw
from bench.challenge.families.wave import (
    WAVES,
    WIDE_LEAD,
    WIDE_SAMPLES,
    conceal,
    known,
    recorded,
)
from bench.discrepancy.data.observables import observe
from bench.physics.base import Base
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

MOVED = {
    "diffuse-tail": ("profile_db[22.5..32.5ns]", 1),
    "pulse-ringing": ("profile_db[6.5..10.5ns]", 1),
    "narrowband-interference": ("noise_std", 1),
    "noise-floor": ("noise_std", 1),
    "path-loss": ("rx_power_dbm", -1),
    "level-control": ("preamble_count", -1),
    "specular-reflections": ("profile_db[15.5..22.5ns]", 1),
    "small-scale-fading": ("rx_power_dbm", -1),
    "quantisation": ("noise_std", 0),
    "pre-echo": ("rise_time_ns", 1),
    "warm-gain": ("rx_power_dbm", -1),
}


@pytest.fixture(scope="module")
def wide() -> pd.DataFrame:
    base = replace(Base(keep_count=0), cir_lead=WIDE_LEAD, cir_samples=WIDE_SAMPLES)
    frame = known(Draw(), 5)[::4].reset_index(drop=True)
    return Simulator(base).observe(scene(frame), 0, complex_cir=True).table(frame)


@pytest.mark.parametrize("name", sorted(WAVES))
def test_every_wave_moves_its_observable(wide: pd.DataFrame, name: str) -> None:
    column, sign = MOVED[name]
    before, out = recorded(wide), recorded(conceal(wide, Draw((name,), 2.0), 3))
    moved = observe(out).column(column) - observe(before).column(column)
    if sign:
        assert np.nanmean(moved) * sign > 0
    else:
        grid = np.abs(np.stack(list(out["cir"])))
        assert (grid == 0).mean() > 0.1
    assert np.allclose(out["range_m"] - out["true_range_m"], out["error_m"])


@pytest.mark.parametrize("name", ["noise-floor", "narrowband-interference"])
def test_noise_reported_is_the_noise_in_the_samples(wide: pd.DataFrame, name: str) -> None:
    out = recorded(conceal(wide, Draw((name,), 2.0), 3))
    late = np.stack(list(out["cir"]))[:, 80:]
    assert late.std(axis=1).mean() == pytest.approx(out["noise_std"].mean(), rel=0.15)


def test_what_rings_on_is_missing_from_the_pulse(wide: pd.DataFrame) -> None:
    drawn = Draw(("pulse-ringing",), 2.0)
    before, out = (recorded(table) for table in (wide, conceal(wide, drawn, 3)))
    assert np.allclose(out["rx_power_dbm"], before["rx_power_dbm"], atol=0.1)
    assert np.mean(out["first_path_power_dbm"] - before["first_path_power_dbm"]) < -0.2


def test_a_case_run_again_has_a_simulator_and_its_rows() -> None:
    case = make_case(0, 5, ("wave",))
    assert isinstance(case.simulated, Simulator)
    assert case.drawn.hidden == ()
    assert case.strength_z == 0
    cirs = [np.stack(list(table["cir"])) for table in (case.recorded.frame, case.clean)]
    assert np.array_equal(*cirs)
