"""A simulator with a tail, whose ranges and levels alone were recorded, is not told from itself."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.physics.base import Base
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

TAILED = Simulator(Base(), (DiffuseTail(level_db=-10.0),))
ROWS = 400


def _recorded() -> View:
    """Return ranges and levels of rows 8 m apart, their samples dropped; SIMULATED."""
    frame = pd.DataFrame({"link": [f"l{row % 40}" for row in range(ROWS)], "true_range_m": 8.0})
    made = TAILED.observe(scene(frame, "here"), seed=5)
    frame = frame.assign(error_m=made.error_m, rx_power_dbm=made.rx_power_dbm)
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
