"""Effects that follow the level follow that of a table's row, with its shadowing in it."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import LEVEL, RANGE, window_of
from bench.discrepancy.data.split import link_codes
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.receiver.level_control import LevelControl, reported_dbm
from tests.bench.discrepancy.numpy_tables import tables


def test_a_control_turns_down_what_arrives_in_a_table_not_the_mean_over_its_distance() -> None:
    recorded, simulated = tables(1, links=250, per_link=5)  # more rows than one block
    window = window_of(recorded.frame)
    rows = np.arange(len(recorded.frame))
    seen = view(recorded.frame, link_codes(recorded.frame), rows, window, None, False)
    table = TableComparison(simulated.frame, window)
    control = LevelControl(compression=0.8, shift_db=2.0)
    bare, held = (table.ensemble(seen, one, 3) for one in ((), (control, AntennaDelay(1.0))))
    level = bare.simulated_of(LEVEL) - 2.0
    read = level + 0.8 * (reported_dbm(level) - level) + 2.0
    assert held.simulated_of(LEVEL) == pytest.approx(read, abs=0.01)
    moved = held.simulated_of(RANGE) - bare.simulated_of(RANGE)
    assert moved == pytest.approx(np.full_like(moved, moved[0, 0]), abs=1e-6)
