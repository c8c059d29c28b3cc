"""Ranges are held beside simulated rows of their own link alone, where it has enough of them."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.residual_range import crowded, residual_range
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.receiver_logs import logs
from bench.discrepancy.select.state import Search
from tests.bench.discrepancy.sets.test_same_rows import LINKS, rows_of


def _compared(versions: int, prefix: str = "l") -> tuple[TableComparison, View, np.ndarray]:
    """Return a table that has what every link is off by, the rows, and what these are off by."""
    frame, own = rows_of(1), np.random.default_rng(2).normal(0, 0.2, LINKS)
    off = own[link_codes(frame)]
    frame = frame.assign(error_m=off, range_m=frame["true_range_m"] + off)
    frame = frame.assign(rx_power_dbm=-80 + 10 * off, preamble_count=1000.0, noise_std=90.0)
    names = prefix + frame["link"].str[1:]
    simulated = pd.concat([frame.assign(link=names)] * versions, ignore_index=True)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    return TableComparison(simulated, Window()), rows, off


def test_a_link_that_has_enough_simulated_rows_needs_none_of_other_links() -> None:
    comparison, rows, _ = _compared(3)
    made = residual_range(comparison, rows, (), 4)
    assert made is not None
    assert np.abs(made[1]).max() < 1e-9
    assert crowded(comparison, rows) == 1.0


def test_what_a_level_arrives_with_is_that_of_the_same_link() -> None:
    comparison, rows, off = _compared(3)
    seen = logs(Search(comparison, rows, rows, {}, 0, work=rows), rows)
    assert seen.arriving_dbm is not None
    assert np.allclose(seen.arriving_dbm, -80 + 10 * off)
    assert seen.freedom == LINKS


@pytest.mark.parametrize(("versions", "prefix"), [(1, "l"), (3, "other")])
def test_simulated_rows_that_several_links_share_count_once(versions: int, prefix: str) -> None:
    comparison, rows, _ = _compared(versions, prefix)
    assert crowded(comparison, rows) == pytest.approx(2.0)
