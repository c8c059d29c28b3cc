from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.errors import BenchError
from bench.recordings.twr import (
    COUNTER_TURN_S,
    SPEED_OF_LIGHT_M_PER_S,
    TICK_S,
    elapsed,
    intervals,
)


def _exchange(range_m: float, offset_ppm: float, reply_s: float, start_s: float) -> pd.DataFrame:
    """Return the timestamps of one exchange; A's clock runs fast by `offset_ppm` against B's."""
    flight = range_m / SPEED_OF_LIGHT_M_PER_S
    sent = np.array([0.0, flight, flight + reply_s, 2 * flight + reply_s])
    sent = np.append(sent, [2 * flight + 1.5 * reply_s, 3 * flight + 1.5 * reply_s])
    fast = 1 + 1e-6 * offset_ppm
    speed = np.array([fast, 1, 1, fast, fast, 1])
    ticks = np.round((sent * speed + start_s) / TICK_S) % 2**40
    return pd.DataFrame([ticks], columns=["T1", "T2", "T3", "T4", "T5", "T6"])


@given(st.floats(0.5, 500), st.floats(-20, 20), st.floats(2e-4, 0.25), st.floats(0, COUNTER_TURN_S))
def test_an_exchange_gives_back_its_range_and_clock_offset(range_m, offset, reply, start) -> None:
    found = intervals(_exchange(range_m, offset, reply, start))
    assert found.double_sided_m()[0] == pytest.approx(range_m, abs=0.02)  # three ticks
    assert found.reply_time_s()[0] == pytest.approx(reply, abs=1e-10)
    assert found.clock_offset_ppm()[0] == pytest.approx(offset, abs=1e-4 / reply)
    drift_m = SPEED_OF_LIGHT_M_PER_S / 2 * reply * offset * 1e-6
    assert found.single_sided_m()[0] - range_m == pytest.approx(drift_m, abs=0.03)


def test_a_fast_initiator_makes_single_sided_ranges_read_long() -> None:
    found = intervals(_exchange(10.0, 1.0, 1e-3, 0.0))
    assert found.single_sided_m()[0] - 10.0 == pytest.approx(0.15, abs=0.01)


def test_no_digit_is_lost_to_the_products() -> None:
    ticks = pd.DataFrame(
        {
            "T1": [57055236684],
            "T2": [56459561043],
            "T3": [69652782156],
            "T4": [70248523212],
            "T5": [70601671244],
            "T6": [70005933158],
        },
        dtype=float,
    )
    ra, db, rb, da = 13193286528, 13193221113, 353151002, 353148032
    exact = (ra * rb - da * db) / (ra + rb + da + db) * TICK_S * SPEED_OF_LIGHT_M_PER_S
    assert intervals(ticks).double_sided_m()[0] == pytest.approx(exact, abs=1e-9)


def test_counters_that_turn_over_in_between() -> None:
    assert elapsed([2.0**40 - 5, 3.0], [7.0, 10.0]).tolist() == [12.0, 7.0]
    assert elapsed([-881874723.0], [-953985108.0], bits=32)[0] == 2**32 - 72110385


def test_an_unknown_timestamp_gives_an_unknown_range() -> None:
    ticks = _exchange(5.0, 0.0, 1e-3, 0.0)
    ticks["T4"] = np.nan
    assert np.isnan(intervals(ticks).double_sided_m()[0])


def test_a_missing_timestamp_column_is_named() -> None:
    with pytest.raises(BenchError, match="no column 'T5'"):
        intervals(_exchange(5.0, 0.0, 1e-3, 0.0).drop(columns="T5"))
