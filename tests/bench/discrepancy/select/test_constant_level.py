"""Levels that are off by so many dB everywhere are no name's."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.select.constant_level import lead_over_constant, level_apart
from bench.discrepancy.sets.settings import RIVAL_NATS
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

FAR = np.linspace(1, 20, 40)


def test_a_transmit_power_does_as_well_as_any_curve() -> None:
    scatter = np.random.default_rng(0).normal(0, 0.5, len(FAR))
    nats, constant_db = lead_over_constant(scatter + 0.1, -5.8 + scatter)
    assert nats < RIVAL_NATS
    assert abs(constant_db + 5.8) < 0.3


def test_a_slope_leads_a_constant() -> None:
    scatter = np.random.default_rng(1).normal(0, 0.5, len(FAR))
    sloped = scatter - 4 * np.log10(FAR)
    assert lead_over_constant(scatter, sloped)[0] > RIVAL_NATS
    few = np.where(np.arange(len(FAR)) == 3, 60.0, 0.0)  # one link behind metal decides nothing
    assert lead_over_constant(scatter + few, sloped + few)[0] > RIVAL_NATS


def test_without_levels_nothing_leads() -> None:
    assert lead_over_constant(FAR[:0], FAR[:0]) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("offset_db", "said"), [(6.0, "-6.0 dB in all rows"), (0.0, "alike without it")]
)
def test_by_how_much_levels_are_apart_is_said(offset_db: float, said: str) -> None:
    """SIMULATED rows of one link each, weaker by some decibels than their simulator's."""
    frame = pd.DataFrame({"true_range_m": FAR, "tx": "t", "rx": "r"})
    weaker = Simulator(Base(), (PathLoss(offset_db=offset_db),), 5, "test")
    made = weaker.observe(scene(frame), 5, 77).table(frame)
    window = window_of(made)
    rows = view(made, np.arange(len(FAR)), np.arange(len(FAR)), window)
    again = Resimulation(Simulator(Base(), (), 11, "test"), window)
    assert said in level_apart(again, rows, ())
    bare = view(made, np.arange(len(FAR)), np.arange(len(FAR)), window, ("error_m",), False)
    assert level_apart(again, bare, ()) == ""
