"""A control of levels on another simulator's table: its own counts, and its own noise."""

import numpy as np
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.effects.receiver.level_control import LevelControl

SYMBOLS = 384.0  # that the other receiver adds up at most, which no column of settings tells


@pytest.fixture(scope="module")
def table() -> ForeignTable:
    frame = Simulator().simulate(line(300, far_m=8.0, los=True)).frame
    return ForeignTable(frame.assign(preamble_count=SYMBOLS))


def test_a_control_that_never_ends_early_leaves_the_counts_of_a_table(table: ForeignTable) -> None:
    made = table.observe((LevelControl(compression=0.0, accumulation=0.0),))
    np.testing.assert_array_equal(made.preamble_count, SYMBOLS)


def test_counts_fall_from_those_of_the_table(table: ForeignTable) -> None:
    made = table.observe((LevelControl(),))
    assert made.preamble_count.max() <= SYMBOLS
    assert made.preamble_count.min() < 0.5 * SYMBOLS  # near, at some -78 dBm


def test_a_gain_that_is_turned_down_leaves_the_noise_of_a_table(table: ForeignTable) -> None:
    made = table.observe((LevelControl(compression=1.0, accumulation=0.0, peak_counts=1e9),))
    plain = np.stack(table.frame["cir"].to_list())
    assert made.cir is not None
    strong = made.rx_power_dbm < table.frame["rx_power_dbm"] - 6
    assert np.median((made.cir / plain)[strong].min(axis=1)) < 0.5
    late = made.cir[strong, -60:].mean() / plain[strong, -60:].mean()  # of noise alone
    assert late == pytest.approx(1, abs=0.1)
