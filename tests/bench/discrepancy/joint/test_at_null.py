"""Whether a set needs a parameter is told by its evidence; SIMULATED rows."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.at_null import likelier, needs
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 40


def _given(hidden: PathLoss) -> Statistics:
    """Return the statistics of rows with a hidden path loss beside a simulator without."""
    rng = np.random.default_rng(3)
    frame = pd.DataFrame({"link": [f"l{i}" for i in range(LINKS)], "tx": "t", "rx": "r"})
    frame["true_range_m"] = rng.uniform(2, 15, LINKS)
    made = Simulator(Base(), (hidden,), 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(made)
    rows = view(made, link_codes(made), np.arange(LINKS), window)
    return Statistics(Resimulation(Simulator(Base(), (), 11, "test"), window), rows)


def test_a_slope_that_is_there_is_needed():
    hidden = PathLoss(exponent=3.0)
    assert needs(_given(hidden), (hidden,), hidden, "exponent")


def test_a_slope_beside_an_offset_that_does_as_well_is_not():
    fitted = PathLoss(exponent=2.02, offset_db=6.0)
    assert not needs(_given(PathLoss(offset_db=6.0)), (fitted,), fitted, "exponent")


def test_what_links_gain_one_by_one_is_there_though_no_value_of_it_is_told():
    hidden = PathLoss(exponent=2.6)
    assert likelier(_given(hidden), (hidden,), hidden)
    assert not likelier(_given(PathLoss()), (hidden,), hidden)
