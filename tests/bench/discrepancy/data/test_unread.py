"""No column vanishes silently: what cannot be used is said, with what was expected."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.data.unread import unread_words
from bench.discrepancy.diagnosis import Options
from bench.discrepancy.prepared import prepared
from bench.discrepancy.select.candidates import library, offered
from bench.recordings.table import Recordings

ROWS = 60


@pytest.fixture
def frame() -> pd.DataFrame:
    """Return a table of which everything can be used."""
    number = np.arange(ROWS)
    return pd.DataFrame(
        {
            "link": [f"l{i // 3}" for i in number],
            "environment": [f"room {i % 30}" for i in number],
            "tx": [f"m{i % 30}" for i in number],
            "rx": "b1",
            "range_m": 5.1 + number % 7,
            "true_range_m": 5.0 + number % 7,
            "los": number % 2 == 0,
            "obstacles": [["wall"] for _ in number],
            "obstacle_clearance_m": [np.array([0.2]) for _ in number],
            "deck": [f"{i % 3}" for i in number],
            "shift": [f"{i % 2}B" for i in number],
            "shaft_rpm": 90.0 + number,
            "crew": "ours",
        }
    )


def test_what_is_used_needs_no_word(frame: pd.DataFrame) -> None:
    assert unread_words(frame) == ()


@pytest.mark.parametrize(
    ("cell", "said"),
    [
        ("{:.1f}", "text such as '90.0', expected numbers, with a decimal point and no unit; not"),
        ("{:.0f} rpm", "text such as '90 rpm', expected numbers"),
        ("{:.1f} °C", "text such as '90.0 °C', expected numbers"),
        ("run-{:.0f}", "text such as 'run-90' with 60 values, too many for a category, expected"),
    ],
)
def test_numbers_as_text_are_said(frame: pd.DataFrame, cell: str, said: str) -> None:
    text = [cell.format(value) for value in frame["shaft_rpm"]]
    (line,) = unread_words(frame.assign(shaft_rpm=text))
    assert line.startswith(f"column shaft_rpm: {said}")


def test_decimal_commas_are_said_however_few_their_values(frame: pd.DataFrame) -> None:
    comma = [f"{value:.1f}".replace(".", ",") for value in frame["shaft_rpm"]]
    (line,) = unread_words(frame.assign(shaft_rpm=comma))
    assert line.endswith("no unit; not used")
    (line,) = unread_words(frame.assign(shaft_rpm=comma[:2] * (ROWS // 2)))
    assert line.endswith("no unit; taken as a category")


def test_text_where_a_unit_is_named_is_said(frame: pd.DataFrame) -> None:
    (line,) = unread_words(frame.assign(time_s=["12:30:01", "12:30:02"] * (ROWS // 2)))
    assert line.startswith("column time_s: text such as '12:30:01', expected numbers")


def test_dates_and_nested_cells_are_said(frame: pd.DataFrame) -> None:
    days = pd.date_range("2026-03-01", periods=ROWS, freq="h")
    lines = unread_words(frame.assign(logged=days, blob=[{"a": 1}] * ROWS))
    assert lines[0].startswith("column logged: Timestamp such as '2026-03-01 00:00:00' with 60")
    assert lines[1] == "column blob: a dict in each cell, expected one number; not used"


def test_empty_columns_share_a_line_and_measured_ones_have_their_own(frame: pd.DataFrame) -> None:
    empty = frame.assign(temperature_c=np.nan, rx_power_dbm=np.nan)
    assert unread_words(empty) == (
        "columns temperature_c, rx_power_dbm: no value in any recorded row; not used",
    )
    (line,) = unread_words(empty, named=("rx_power_dbm",))
    assert line == "column temperature_c: no value in any recorded row; not used"


def test_an_empty_temperature_cannot_be_tried(frame: pd.DataFrame) -> None:
    """With times a warming is tried over time; with neither it is said that it was not."""
    _, lacking = offered(library()[0], frame.assign(temperature_c=np.nan), waveform=False)
    assert lacking["temperature-drift"].startswith("could not be tried: needs temperature_c")
    able, _ = offered(
        library()[0], frame.assign(temperature_c=np.nan, time_s=1.0 * np.arange(ROWS)), False
    )
    assert "temperature-drift" in able


def test_the_line_is_among_those_of_both_tables(frame: pd.DataFrame) -> None:
    comma = [f"{value:.1f}".replace(".", ",") for value in frame["shaft_rpm"]]
    again = frame.assign(range_m=frame["range_m"] + 0.01)
    both = (Recordings(frame.assign(shaft_rpm=comma), "mine"), Recordings(again, "made"))
    lines = [line for line in prepared(*both, Options()).counted if "shaft_rpm" in line]
    assert lines == list(unread_words(both[0].frame))
    assert len(lines) == 1
