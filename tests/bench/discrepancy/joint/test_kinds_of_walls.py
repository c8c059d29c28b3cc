"""Walls: every kind of them delays and weakens by another size, and metal lets nothing through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.likelihood import link_nats, misfits
from bench.discrepancy.joint.mixture import in_place
from bench.discrepancy.joint.polish import polished
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.base import Base
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 80
KINDS = ([], ["brick"], ["plywood"], ["metal"])
TRULY = {"brick": MaterialDelay(loss_scale=2.0), "plywood": MaterialDelay(loss_scale=0.4)}


def listed() -> pd.DataFrame:
    """Return 80 links of which three in four have something in their way."""
    rng = np.random.default_rng(4)
    return pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(3, 12, LINKS),
            "obstacles": [KINDS[i % 4] for i in range(LINKS)],
        }
    )


def recorded() -> pd.DataFrame:
    """Return recordings in which the loss of either kind is another; SIMULATED."""
    frame = listed()
    first = frame["obstacles"].str[0]
    parts = []
    for kind in ("brick", "plywood"):
        made = Simulator(Base(), (TRULY[kind],), 5, "test").observe(scene(frame), 5, 77)
        parts.append(made.table(frame))
    return parts[1].where(first != "brick", parts[0])


def statistics() -> Statistics:
    """Return these beside a simulator without walls."""
    frame = recorded()
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Statistics(Resimulation(Simulator(Base(), (), 11, "test"), window), rows)


def test_walls_of_two_kinds_are_of_one_name_though_no_one_scale_is_right():
    given = statistics()
    fit = polished(given, (MaterialDelay(),))
    assert fit is not None
    assert given.kinds.sum(axis=0).tolist() == [20, 20, 20]
    uniform = replace(fit.moments, own=None, uneven=None)
    left, of_uniform = (misfits(given, one, fit.responses) for one in (fit.moments, uniform))
    assert (left**2).mean() < 1 < (of_uniform**2).mean()
    sets = Sets(given.comparison, given.rows, given.rows, (MaterialDelay, Diffraction, PathLoss))
    assert [effect.name for effect in sets.chosen().named] == ["material-delay"]


def test_links_are_asked_whether_they_were_struck_beside_what_their_kind_of_wall_does():
    given = statistics()
    fit = polished(given, (MaterialDelay(),))
    assert fit is not None
    made = given.needed(fit.effects), in_place(given, fit.effects)
    whole, less = (link_nats(given, one, ()) for one in made)
    through = given.kinds.any(axis=1)
    assert (less - whole)[through].sum() > 10 * NAME_NATS
    assert np.abs((less - whole)[~through]).max() < 0.1


def test_what_metal_does_is_left_to_diffraction():
    frame = listed()
    bare, walls = (
        Simulator(Base(), effects, 5, "test").observe(scene(frame), 5, 77).table(frame)
        for effects in ((), (MaterialDelay(),))
    )
    less = (bare["rx_power_dbm"] - walls["rx_power_dbm"]).groupby(frame["obstacles"].str[0]).mean()
    assert less["metal"] == 0
    assert less["brick"] > 3
