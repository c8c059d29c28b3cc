"""A receiver's own curve of levels is read off the levels, whatever its form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import LEVEL, Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.backfitting import polished
from bench.discrepancy.select.control_curve import rising, with_curve
from bench.discrepancy.select.logged import read_logs
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from tests.bench.discrepancy.numpy_tables import tables

Floats = NDArray[np.float64]
WORLD = Simulator(Base(), (), 3)


def search_of(fallen_db: Callable[[Floats], Floats], count: float, *lost: PathLoss) -> Search:
    """Return a search of recordings (SIMULATED) that fall by so much at what arrives in dBm."""
    frame = tables(4)[0].frame
    arrives = Simulator(Base(), lost, 3).observe(scene(frame), cir=False).rx_power_dbm
    assert arrives is not None
    fallen = fallen_db(np.asarray(arrives, np.float64))
    counted = np.rint(1024 * 10 ** (-count * fallen / 10))
    shown = frame.assign(rx_power_dbm=arrives - fallen, preamble_count=counted)
    rows = view(shown, link_codes(shown), np.arange(len(shown)), Window(), None, False)
    kinds = {"level-control": LevelControl}
    return Search(Resimulation(WORLD, Window()), rows, rows, kinds, 0, work=rows)


def squared(level_dbm: Floats) -> Floats:
    return np.asarray(0.02 * np.maximum(level_dbm + 88, 0) ** 2)


def left_db(search: Search, *effects: Effect) -> float:
    made = search.comparison.ensemble(search.both, effects, 4)
    return float(np.abs(made.residual_of(LEVEL)).mean())


def test_counts_show_a_control_and_levels_its_curve() -> None:
    search = read_logs(search_of(squared, 1.0))
    (control,) = search.logged
    assert isinstance(control, LevelControl)
    assert left_db(search) > 0.5
    assert left_db(search, control) < 0.03
    again = polished(search.comparison, search.fit, (control,))[0]
    assert isinstance(again, LevelControl)
    assert again.curve_db == control.curve_db


def test_a_curve_and_a_path_loss_beside_it_are_told_apart() -> None:
    search = search_of(squared, 1.0, PathLoss(exponent=2.5))
    alone = with_curve(search, (LevelControl(),))
    assert left_db(search, *alone) > 0.3  # weak signals are not turned down
    control, loss = with_curve(search, (LevelControl(), PathLoss(exponent=2.2)))
    assert isinstance(control, LevelControl)
    assert isinstance(loss, PathLoss)
    assert loss.exponent == pytest.approx(2.5, abs=0.2)
    assert left_db(search, control, loss) < 0.1


def test_a_curve_only_rises_and_is_not_bent_by_a_few_rows_behind_obstacles() -> None:
    rng = np.random.default_rng(2)
    level = rng.uniform(-98, -70, 400)
    fallen = 1.5 * (level > -82) + 0.1 * rng.normal(size=400) + 15.0 * (rng.random(400) < 0.04)
    knots, curve = rising(level, fallen)
    assert (np.diff(curve) >= 0).all()
    assert curve[0] >= 0
    assert np.interp([-95.0, -88.0, -78.0], knots, curve) == pytest.approx([0, 0, 1.5], abs=0.15)
    assert (rising(level, -fallen)[1] < 0.05).all()  # what reads louder is turned down by nothing
