"""Tables of the same places have the same mix, however their means were added up; SIMULATED."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes


def _table(rows: int, higher_m: float = 0.0) -> pd.DataFrame:
    """Return `rows` of each of 40 links between tags at one height and anchors at three."""
    heights = np.array([2.1, 2.3, 2.7])[np.arange(40) % 3] + higher_m
    link = np.repeat(np.arange(40), rows)
    true = np.repeat(np.linspace(1, 20, 40), rows)
    return pd.DataFrame({"link": link, "true_range_m": true, "tx_z_m": 1.1, "error_m": 0.0}).assign(
        rx_z_m=heights[link]
    )


@pytest.mark.parametrize(("higher_m", "alike"), [(0.0, True), (0.5, False)])
def test_what_means_are_rounded_by_is_no_other_mix(higher_m: float, alike: bool) -> None:
    recorded, other = _table(7, higher_m), _table(3)
    rows = view(recorded, link_codes(recorded), np.arange(len(recorded)), Window(), None, False)
    found = TableComparison(other, Window()).mix(rows)
    assert (found["rx_z_m"][1] > 0.9) is alike
    assert found["true_range_m"][1] > 0.9
