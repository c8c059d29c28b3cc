"""Columns of the user's own: which are measured, and that it can be said."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.data.own_columns import measured_columns
from bench.errors import BenchError

LINKS, ROWS = 30, 6


@pytest.fixture
def frame() -> pd.DataFrame:
    """Return a table with columns of four kinds of the user's own."""
    rng = np.random.default_rng(0)
    link = np.repeat(np.arange(LINKS), ROWS)
    rows = len(link)
    return pd.DataFrame(
        {
            "link": [f"l{i}" for i in link],
            "true_range_m": 5.0 + link,
            "error_m": rng.normal(0, 0.1, rows),
            "rx_power_dbm": rng.normal(-80, 3, rows),
            "supply_v": rng.uniform(2.8, 3.6, LINKS)[link] + rng.normal(0, 0.02, rows),
            "humidity": np.linspace(20, 60, rows),
            "mystery": rng.normal(0, 1, rows),
            "chip_snr_db": rng.uniform(5, 30, LINKS)[link],
            "tx_level": rng.uniform(0, 5, LINKS)[link],
            "mode": rng.integers(0, 3, rows),
        }
    )


def test_scatter_and_names_give_measured_columns_away(frame):
    assert set(measured_columns(frame)) == {"mystery", "chip_snr_db"}


def test_a_condition_is_known_before_however_it_scatters(frame):
    scattered = frame["mystery"]
    named = frame.assign(**dict.fromkeys(("supply_v", "humidity", "reply_time_s"), scattered))
    assert set(measured_columns(named)) == {"mystery", "chip_snr_db"}


def test_a_counter_is_measured_whatever_it_is_named_for(frame):
    ticks = frame["humidity"] * 1e9
    named = frame.assign(resp_tx_ts=ticks, tx_timestamp=ticks)
    assert {"resp_tx_ts", "tx_timestamp"} <= set(measured_columns(named))


def test_a_second_receivers_registers_are_measured_too(frame):
    slow = frame["humidity"]
    names = ("poll_preamble_count", "range_raw_m", "bias_correction_m", "rxpacc_tag")
    named = frame.assign(**dict.fromkeys(names, slow), true_range_of_survey_m=slow)
    assert set(measured_columns(named)) == {"mystery", "chip_snr_db", *names}


def test_the_user_knows_better(frame):
    said = measured_columns(frame, ("humidity",), ("mystery", "chip_snr_db"))
    assert said == ("humidity",)


@pytest.mark.parametrize(
    ("measured", "known", "words"),
    [
        (("mystery",), ("mystery",), "both name mystery"),
        (("mistery",), (), "no column 'mistery'"),
        ((), ("rx_power_dbm",), "never known"),
    ],
)
def test_what_cannot_be_is_one_clear_line(frame, measured, known, words):
    with pytest.raises(BenchError, match=words):
        measured_columns(frame, measured, known)
