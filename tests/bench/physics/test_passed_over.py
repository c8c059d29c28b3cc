"""What a table's own detector passes over is no first path in what effects make of the table."""

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.detection import first_path
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.passed_over import begins, most_often

AHEAD = 3  # samples, that a side lobe lies before the pulse


def lobed(share: float) -> pd.DataFrame:
    """Return a table whose pulses have a side lobe of a share before them, which is passed over."""
    frame = Simulator().simulate(line(300, far_m=8.0, los=True)).frame
    cir = np.stack(frame["cir"].to_list())
    ahead = np.roll(cir, -AHEAD, axis=1)
    ahead[:, -AHEAD:] = 0
    return frame.assign(cir=list(np.maximum(cir, share * ahead)))


def test_a_side_lobe_that_sinks_below_the_threshold_moves_no_path() -> None:
    table = ForeignTable(lobed(0.1))
    made = table.observe((PathLoss(offset_db=10.0),))
    plain = table.frame
    assert made.first_path_index is not None
    assert np.abs(made.first_path_index - plain["first_path_index"]).max() < 0.3
    assert np.abs(made.range_m - plain["range_m"]).max() < 0.1
    fell = made.first_path_power_dbm - plain["first_path_power_dbm"]
    assert np.median(fell) == pytest.approx(-10, abs=0.2)


def test_a_detector_that_agrees_looks_at_all_samples() -> None:
    frame = Simulator().simulate(line(300, far_m=8.0, los=True)).frame
    assert not ForeignTable(frame)._begin.any()


def test_an_index_that_scatters_makes_nothing_be_passed_over() -> None:
    magnitude = np.zeros((400, 40), np.float32)
    magnitude[:, 9:12] = [50, 100, 50]
    magnitude[:, 20:23] = [40, 80, 40]
    index = 9 + np.random.default_rng(2).normal(0, 1, 400)
    begin = begins(magnitude, np.full(400, 30.0), index)
    assert (first_path(magnitude, np.full(400, 30.0), begin=begin) < 12).all()


def test_most_of_the_values_decide() -> None:
    assert most_often(np.array([-4, -3.5, -3, 0, 0.1, 0.2, 0.1])) == pytest.approx(0.1, abs=0.06)
    assert most_often(np.array([])) == 0.0


def test_the_way_in_which_most_values_lie_together_decides() -> None:
    apart, alike = np.array([-9.0, -3.0, 0.0, 4.0]), np.array([0.5, 0.5, 0.6, 7.0])
    assert most_often(apart, alike) == pytest.approx(0.5, abs=0.06)
