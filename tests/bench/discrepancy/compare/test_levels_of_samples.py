"""A simulator with a tail, whose ranges and levels alone were recorded, is not told from itself."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.receiver_logs import logs
from bench.physics.base import Base
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.quantisation import Quantisation
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

OFFSET = Simulator(Base(), (Quantisation(offset_counts=200.0),))
TAILED = Simulator(Base(), (DiffuseTail(level_db=-10.0),))
ROWS = 400


def _recorded(simulator: Simulator = TAILED) -> View:
    """Return ranges, levels and noise of rows 8 m apart, their samples dropped; SIMULATED."""
    frame = pd.DataFrame({"link": [f"l{row % 40}" for row in range(ROWS)], "true_range_m": 8.0})
    made = simulator.observe(scene(frame, "here"), seed=5)
    frame = frame.assign(
        error_m=made.error_m, rx_power_dbm=made.rx_power_dbm, noise_std=made.noise_std
    )
    every = np.arange(ROWS)
    return view(frame, link_codes(frame), every, window_of(frame), None, False)


def test_levels_scatter_as_those_of_samples_do():
    rows = _recorded()
    level = Resimulation(TAILED, window_of(rows.frame)).ensemble(rows, (), 4)
    made = level.versions_of("rx_power_dbm")
    assert made[0].std() > 0.1
    assert 0.8 < made[1:].std(axis=1).mean() / made[0].std() < 1.25


def test_samples_are_made_only_where_levels_hang_on_them():
    assert TAILED.of_samples
    assert not Simulator(Base(), (PathLoss(),)).of_samples


def test_the_noise_that_a_simulator_logs_of_its_samples_is_its_own():
    """An offset of the accumulator is in the noise that is logged of samples."""
    rows = _recorded(OFFSET)
    search = SimpleNamespace(comparison=Resimulation(OFFSET, window_of(rows.frame)))
    off_db = logs(search, rows).noise_db
    assert abs(float(np.median(off_db))) < 0.25
    bare = 20 * np.log10(OFFSET.observe(rows.scene, cir=False).noise_std)
    assert float(np.median(20 * np.log10(rows.frame["noise_std"]) - bare)) > 0.5
