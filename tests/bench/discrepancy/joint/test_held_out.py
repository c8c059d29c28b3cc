"""Waveforms of links that nothing was tuned on say by their likelihood what they lack."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.joint.held_out import likelier_struck, likelier_with
from bench.discrepancy.select.link_mixture import Strike
from bench.physics.base import Base
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
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


def _strike(hidden: ObstructedPath) -> Strike:
    """Return a strike of links as others told it: how many, within a tenth or so."""
    every = [
        ParameterEstimate(p.name, value, value, value, p.unit, False)
        for p in free_parameters(ObstructedPath)
        if (value := float(getattr(hidden, p.name))) == value and p.name != "share"
    ]
    share = ParameterEstimate("share", 0.4, 0.3, 0.5, "ratio", False)
    none = np.empty(0, np.intp)
    return Strike(hidden, Estimate(50.0, 40.0, 60.0, "nats"), (share, *every), none)


@pytest.mark.parametrize("struck", [True, False])
def test_held_out_links_are_likelier_struck_where_some_are(struck: bool) -> None:
    """Nobody can predict which: a mean over all links is that of none."""
    obstacle = ObstructedPath(share=0.4, loss_db=12.0, loss_spread_db=3.0)
    frame = _recorded((obstacle,) if struck else ()).drop(columns="obstacles")
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    comparison = Resimulation(Simulator(Base(), (), 11, "test"), window)
    assert likelier_struck(comparison, rows, (), _strike(obstacle)) is struck
