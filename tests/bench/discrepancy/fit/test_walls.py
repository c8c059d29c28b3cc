"""What every kind of obstacle delays, from ranges and levels."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.bootstrap import _exchanged, latent_values
from bench.discrepancy.fit.walls import delays_of_kinds, of_every_kind, wall_delay
from bench.discrepancy.report.beside_values import wall_lines
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.fitted.wall_delay import WallDelay
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.slabs import UNLISTED, crossed, kinds_crossed

HIDDEN = WallDelay(("brick", "glass"), (0.1, 0.3), (3.0, 6.0))
LISTED = ([], ["brick"], ["glass"], ["glass", "glass"], ["metal"])
SIMULATOR = Simulator(Base(), (), 0)


def _frame() -> pd.DataFrame:
    rng = np.random.default_rng(1)
    rows = np.arange(200)
    frame = pd.DataFrame({"true_range_m": rng.uniform(4, 40, 200)})
    frame["obstacles"] = [LISTED[row % 5] for row in rows]
    frame["link"] = (rows // 4).astype(str)
    made = Simulator(Base(), (HIDDEN,), 0).observe(scene(frame), 0, cir=False)
    assert made.range_m is not None
    frame["range_m"] = made.range_m + 0.01 * rng.normal(size=200)
    frame["error_m"] = frame["range_m"] - frame["true_range_m"]
    frame["rx_power_dbm"] = made.rx_power_dbm
    return frame


def _view(frame: pd.DataFrame) -> View:
    names = ("error_m", "rx_power_dbm")
    return view(frame, link_codes(frame), np.arange(len(frame)), Window(), names, False)


def test_every_kind_has_a_delay_and_losses_of_its_own() -> None:
    rows = _view(_frame())
    found = wall_delay(Resimulation(SIMULATOR, Window()), rows, ())
    assert found is not None
    assert found.kinds == HIDDEN.kinds
    assert found.delays_m == pytest.approx(HIDDEN.delays_m, abs=0.01)
    assert found.losses_db == pytest.approx(HIDDEN.losses_db, abs=0.3)
    made = latent_values(rows, found)
    assert made is not None
    assert made[0] == ("delay_m[brick]", "delay_m[glass]")


def test_nothing_goes_through_metal_and_clear_rows_stay_as_they_are() -> None:
    rows = scene(_frame())
    assert kinds_crossed(rows) == ("brick", "glass")
    walls = crossed(rows, HIDDEN.kinds)
    assert walls[:5].tolist() == [[0, 0], [1, 0], [0, 1], [0, 2], [0, 0]]


def test_one_that_is_twice_as_thick_counts_two() -> None:
    frame = pd.DataFrame({"true_range_m": [5.0], "obstacles": [["brick"]]})
    frame["obstacle_thickness_m"] = [[0.28]]
    assert crossed(scene(frame), ("brick",))[0, 0] == pytest.approx(2.0)


def test_a_wall_that_nobody_listed_is_a_kind_of_its_own() -> None:
    frame = pd.DataFrame({"true_range_m": [5.0, 6.0], "los": [True, False]})
    assert kinds_crossed(scene(frame)) == (UNLISTED,)
    assert crossed(scene(frame), (UNLISTED,)).ravel().tolist() == [0, 1]


def test_walls_only_delay() -> None:
    walls = np.eye(2)[np.arange(100) % 2]
    left_m = np.where(np.arange(100) % 2, -0.2, 0.1)
    assert delays_of_kinds(walls, left_m) == pytest.approx([0.1, 0.0], abs=0.001)
    with pytest.raises(BenchError):
        WallDelay(("brick",), (-0.1,))


def test_links_behind_walls_are_taken_for_one_another_and_for_no_others() -> None:
    codes, links = np.repeat(np.arange(8), 3), np.arange(8)
    acts = links < 3
    drawn = _exchanged(codes, links, acts)
    behind = codes < 3
    assert all(((codes[rows] < 3) == behind).all() for rows in drawn)
    assert any((codes[rows] != codes).any() for rows in drawn)


def test_beside_what_walls_do_to_waveforms_ranges_say_what_each_kind_delays() -> None:
    """One scale of a tabled thickness would have glass, which is thin there, delay less."""
    rows = _view(_frame())
    found = of_every_kind(
        Resimulation(SIMULATOR, Window()), rows, (), MaterialDelay(delay_scale=4.0)
    )
    assert found is not None
    assert found.kinds == HIDDEN.kinds
    assert found.delay_scale == 1.0
    assert found.delays_m == pytest.approx(HIDDEN.delays_m, abs=0.01)


def test_a_wall_of_which_ranges_told_delays_so_and_weakens_as_before() -> None:
    rows = scene(_frame())
    plain = MaterialDelay()
    told = MaterialDelay(kinds=HIDDEN.kinds, delays_m=HIDDEN.delays_m)
    open_way, walls, by_kind = (
        Simulator(Base(), some, 0).observe(rows, 0, cir=False) for some in ((), (plain,), (told,))
    )
    assert by_kind.range_m is not None
    assert open_way.range_m is not None
    later = by_kind.range_m - open_way.range_m
    assert later == pytest.approx(crossed(rows, HIDDEN.kinds) @ HIDDEN.delays_m, abs=1e-3)
    assert by_kind.rx_power_dbm == pytest.approx(walls.rx_power_dbm)


def test_beside_waveforms_levels_say_what_each_kind_takes() -> None:
    """One scale of tabled losses would have brick take more than glass."""
    frame = _frame()
    made = Simulator(Base(), (HIDDEN,), 0).observe(scene(frame), 0, cir=False)
    frame["first_path_power_dbm"] = made.first_path_power_dbm
    names = ("error_m", "rx_power_dbm", "first_path_power_dbm")
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), names, False)
    comparison = Resimulation(SIMULATOR, Window())
    found = of_every_kind(comparison, rows, (), MaterialDelay(loss_scale=3.0))
    assert found is not None
    assert found.loss_scale == 1.0
    assert found.losses_db == pytest.approx(HIDDEN.losses_db, abs=0.3)
    assert found.delays_m == pytest.approx(HIDDEN.delays_m, abs=0.01)


def test_a_wall_of_which_levels_told_takes_that_of_the_straight_path() -> None:
    rows = scene(_frame())
    plain, told = (
        Simulator(Base(), some, 0).observe(rows, 0, cir=False)
        for some in (
            (),
            (MaterialDelay(kinds=HIDDEN.kinds, losses_db=(3.0, 6.0), delays_m=(0, 0)),),
        )
    )
    assert plain.rx_power_dbm is not None
    assert told.rx_power_dbm is not None
    lost = plain.rx_power_dbm - told.rx_power_dbm
    assert lost == pytest.approx(crossed(rows, HIDDEN.kinds) @ (3.0, 6.0), abs=1e-3)


def test_the_report_says_what_walls_take_beside_waveforms() -> None:
    told = MaterialDelay(kinds=HIDDEN.kinds, losses_db=(3.0, 6.0), delays_m=(0.1, 0.3))
    assert any("brick 3 dB, glass 6 dB" in line for line in wall_lines(told))
    assert not wall_lines(MaterialDelay())
