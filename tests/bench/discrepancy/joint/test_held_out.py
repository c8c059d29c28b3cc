"""Waveforms of links that nothing was tuned on say by their likelihood what they lack."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.held_out import likelier_with
from bench.physics.base import Base
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 40


def _recorded(hidden: Added) -> pd.DataFrame:
    """Return recordings of links half of which pass a wall; SIMULATED."""
    rng = np.random.default_rng(4)
    frame = pd.DataFrame({"link": [f"l{i}" for i in range(LINKS)]})
    frame["true_range_m"] = rng.uniform(3, 12, LINKS)
    frame["obstacles"] = [[["brick"], []][i % 2] for i in range(LINKS)]
    return Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)


@pytest.mark.parametrize("hidden", [(MaterialDelay(),), ()])
def test_held_out_links_are_likelier_with_what_they_have_alone(hidden: Added) -> None:
    frame = _recorded(hidden)
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    comparison = Resimulation(Simulator(Base(), (), 11, "test"), window)
    wall = MaterialDelay()
    said = likelier_with(comparison, rows, (RangeScale(scale=0.01), wall), wall)
    assert said is bool(hidden)
