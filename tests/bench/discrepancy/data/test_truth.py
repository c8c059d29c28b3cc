"""Truths that cannot be, refused with one line."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.data.truth import check_hidden, check_positive, check_truth
from bench.errors import BenchError
from bench.recordings.clean import NEGATIVE
from bench.recordings.table import Recordings

FOOT = 0.3048


@pytest.mark.parametrize(("below", "refused"), [(2, False), (20, True)])
def test_differences_of_distances_are_no_distances(below: int, refused: bool) -> None:
    table = Recordings(made(), "mine", dropped={NEGATIVE: below, "no range error": 3})
    if not refused:
        check_positive(table)
        return
    with pytest.raises(BenchError, match=r"negative in 20 of 83 rows: expected distances"):
        check_positive(table)


def made(**other: object) -> pd.DataFrame:
    """Return sixty ranges of 2 to 30 m with their positions, 5 cm of scatter; SIMULATED."""
    truth = np.linspace(2.0, 30.0, 60)
    measured = truth + 0.05 * np.random.default_rng(0).standard_normal(60)
    frame = pd.DataFrame({"true_range_m": truth, "range_m": measured, "tx_x_m": truth})
    rest = dict.fromkeys(("tx_y_m", "tx_z_m", "rx_x_m", "rx_y_m", "rx_z_m"), 0.0)
    return frame.assign(**rest).assign(**other)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ({"true_range_m": made()["true_range_m"] / FOOT}, "range_m and true_range_m .* of feet"),
        ({"range_m": made()["range_m"] / FOOT}, "range_m and true_range_m .* of feet"),
        ({"tx_x_m": made()["tx_x_m"] / FOOT}, "positions tx_x_m .. rx_z_m .* of feet"),
        ({"tx_x_m": 2 * made()["tx_x_m"]}, "16 m nearer or farther than true_range_m"),
        ({"range_m": made()["true_range_m"], "true_range_m": made()["range_m"]}, "two swapped"),
        ({"range_m": made()["true_range_m"]}, "the range error is 0 in every row"),
    ],
)
def test_what_cannot_be_is_refused(other: dict[str, pd.Series], said: str) -> None:
    with pytest.raises(BenchError, match=said):
        check_truth(made(**other), "r.parquet")


def test_ranges_that_can_be_pass() -> None:
    check_truth(made(), "r.parquet")
    check_truth(made().drop(columns=["tx_x_m"]), "r.parquet")
    late = made()["true_range_m"] + 154.0  # delays that nobody calibrated
    check_truth(made(range_m=late), "r.parquet")
    one = made(true_range_m=2.0, range_m=2.0 / FOOT, tx_x_m=2.0)  # an offset may do that
    check_truth(one, "r.parquet")


def test_hiding_the_range_is_refused_where_nothing_else_is_left() -> None:
    frame = made(cir=[np.ones(4)] * 60)
    check_hidden(frame, ("range_m",), "r.parquet")
    check_hidden(frame.drop(columns="cir"), ("tx_x_m",), "r.parquet")
    with pytest.raises(BenchError, match="with range_m hidden no range error is left"):
        check_hidden(frame.drop(columns="cir"), ("range_m",), "r.parquet")
