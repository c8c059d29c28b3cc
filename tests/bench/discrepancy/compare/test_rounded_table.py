"""Effects that round the range of a table's rows round it with the rows' own errors in it."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import RANGE, window_of
from bench.discrepancy.data.split import link_codes
from bench.physics.effects.ranging.range_rounding import RangeRounding
from tests.bench.discrepancy.numpy_tables import tables


def test_simulated_ranges_of_a_table_lie_on_the_grid() -> None:
    recorded, simulated = tables(1, links=250, per_link=5)  # more rows than one block
    window = window_of(recorded.frame)
    rows = np.arange(len(recorded.frame))
    seen = view(recorded.frame, link_codes(recorded.frame), rows, window, None, False)
    made = TableComparison(simulated.frame, window).ensemble(seen, (RangeRounding(0.1),), 2)
    ranges = made.simulated[..., made.names.index(RANGE)] + seen.scene.true_range_m
    assert ranges / 0.1 == pytest.approx(np.rint(ranges / 0.1), abs=1e-3)
