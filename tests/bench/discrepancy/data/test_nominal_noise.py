"""Logged noise that is a figure of the simulator's is told from noise that samples hold."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.counterpart import counted
from bench.discrepancy.data.nominal_noise import nominal_noise, untrue_logs
from bench.physics import Simulator
from bench.physics.base import Base
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.recordings.table import Recordings

LEAD = Base(cir_lead=30)  # samples of noise alone before the path
QUIET = Simulator(LEAD, seed=1)
LOUD = Simulator(LEAD, (NoiseFloor(level_db=6.0),), seed=2)


def table(simulator: Simulator, nominal: bool) -> pd.DataFrame:
    """Return rows of a simulator, with its noise as it was asked for or as it is; SIMULATED."""
    rng = np.random.default_rng(4)
    frame = pd.DataFrame({"link": [f"l{i // 4}" for i in range(400)]})
    frame = simulator.simulate(frame.assign(true_range_m=rng.uniform(3, 12, 400))).frame
    return frame.assign(noise_std=41.0) if nominal else frame


def test_a_log_that_samples_contradict_is_not_compared() -> None:
    ours, theirs = table(LOUD, True), table(QUIET, True)
    assert nominal_noise(ours, theirs) == pytest.approx(6.0, abs=0.7)
    assert nominal_noise(theirs, ours) == pytest.approx(-6.0, abs=0.7)
    assert untrue_logs([ours, theirs]) == ("noise_std",)
    lines = counted(Recordings(ours, "mine"), Recordings(theirs, "theirs"))
    assert any("dB more noise before the path: it is not of the samples" in one for one in lines)


@pytest.mark.parametrize("ours", [LOUD, QUIET], ids=["louder", "as loud"])
def test_a_log_that_follows_the_samples_stays(ours: Simulator) -> None:
    assert nominal_noise(table(ours, False), table(QUIET, False)) == 0.0
    assert untrue_logs([table(ours, False), table(QUIET, False)]) == ()


def test_without_waveforms_or_log_nothing_is_told() -> None:
    ours, theirs = table(LOUD, True), table(QUIET, True)
    for name in ("cir", "noise_std", "first_path_index"):
        assert nominal_noise(ours.drop(columns=name), theirs) == 0.0
    assert nominal_noise(ours, theirs.assign(noise_std=np.nan)) == 0.0
    assert untrue_logs([ours]) == ()
