from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from recordings_factory import cells, make_frame

from bench.errors import BenchError
from bench.recordings.clean import _as_names, add_counts, clean, describe


def _with(rows: int = 20, **bad) -> pd.DataFrame:
    """Return a good table whose first row has the given values."""
    frame = make_frame(rows=rows, width=30, links=4)
    frame = frame.astype({name: object for name in bad if name in frame})
    for name, value in bad.items():
        if name not in frame:
            frame[name] = pd.Series([None] * rows, dtype=object)
        frame.at[0, name] = value
    return frame


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        ({"range_m": np.nan}, "no range error"),
        ({"true_range_m": None}, "no range error"),
        ({"range_m": "n/a"}, "range_m is not a number"),
        ({"range_m": np.inf}, "range_m is infinite"),
        ({"rx_power_dbm": -np.inf}, "rx_power_dbm is infinite"),
        ({"range_m": 1500.0}, "error beyond 1 km"),
        ({"rx_power_dbm": -1e9}, "rx_power_dbm is no level"),
        ({"true_range_m": -0.5}, "negative true range"),
        ({"error_m": 3.0}, "error_m contradicts range_m - true_range_m"),
        ({"link": None}, "no link"),
        ({"cir": np.ones(29, np.float32)}, "CIR not of length 30"),
        ({"cir": None}, "no CIR"),
        ({"cir": np.full(30, np.nan, np.float32)}, "NaN in the CIR"),
        ({"cir": np.full(30, np.inf, np.float32)}, "NaN in the CIR"),
        ({"cir": np.zeros(30, np.float32)}, "CIR zero throughout"),
        ({"first_path_index": -1.0}, "first path outside the CIR"),
        ({"first_path_index": 30.0}, "first path outside the CIR"),
    ],
)
def test_a_bad_row_is_dropped_under_its_reason(bad, reason: str) -> None:
    frame = _with(**bad)
    if "error_m" in bad:
        frame["error_m"] = (frame["range_m"] - frame["true_range_m"]).where(frame.index > 0, 3.0)
    cleaned = clean(frame, "t")
    assert cleaned.dropped == {reason: 1}
    assert len(cleaned.frame) == 19
    assert cleaned.frame["range_m"].iloc[0] == frame["range_m"].iloc[1]


def test_ranges_in_another_unit_than_the_truth_are_asked_about() -> None:
    frame = _with()
    frame["range_m"] = 1000 * frame["true_range_m"] + 1000
    with pytest.raises(BenchError, match=r"1 km.*both in metres"):
        clean(frame, "t")


def test_a_value_that_is_not_known_is_kept() -> None:
    cleaned = clean(_with(rx_power_dbm=None, los=None, first_path_index=np.nan, time_s=""), "t")
    assert cleaned.dropped == {}
    assert cleaned.frame["los"].isna().sum() == 1
    assert cleaned.frame["time_s"].dtype == np.float64


def test_timestamps_explain_an_error_beyond_a_kilometre() -> None:
    frame = _with(range_m=2000.0)
    for stamp in ("T1", "T2", "T3", "T4", "T5", "T6"):
        frame[stamp] = 1.0
    assert clean(frame, "t").dropped == {}


def test_the_complex_accumulator_gives_the_magnitude() -> None:
    frame = make_frame(rows=8, width=10).drop(columns="cir")
    frame["cir_i"], frame["cir_q"] = cells(np.full((8, 10), 3.0)), cells(np.full((8, 10), -4.0))
    cleaned = clean(frame, "t").frame
    np.testing.assert_array_equal(np.stack(cleaned["cir"]), np.full((8, 10), 5.0, np.float32))


def test_numbers_as_link_names_become_text_without_a_fraction() -> None:
    frame = make_frame(rows=6)
    frame["link"], frame["environment"] = [1, 1, 2, 2, 3, 3], [1.0, None, 2.0, 2.0, 2.0, 2.0]
    cleaned = clean(frame, "t").frame
    assert cleaned["link"].tolist() == ["1", "1", "2", "2", "3", "3"]
    assert cleaned["environment"].dropna().tolist() == ["1", "2", "2", "2", "2"]


@pytest.mark.parametrize("words", [["true", "FALSE"], ["1", "0"], [1, 0], ["yes", "No"], [1.0, 0]])
def test_line_of_sight_may_be_said_in_several_ways(words) -> None:
    frame = make_frame(rows=6).assign(los=words * 3)
    assert clean(frame, "t").frame["los"].tolist() == [True, False] * 3


def test_a_strange_line_of_sight_label_is_refused() -> None:
    with pytest.raises(BenchError, match="'los' holds 'maybe'; expected true or false"):
        clean(_with(los="maybe"), "t")


def test_more_than_half_bad_is_an_error_naming_the_reasons() -> None:
    frame = make_frame(rows=10)
    frame.loc[:5, "range_m"] = np.nan
    with pytest.raises(BenchError, match="t: 6 of 10 rows are unusable \\(6 no range error\\)"):
        clean(frame, "t")
    frame.loc[:0, "range_m"] = 5.0
    frame.loc[:0, "true_range_m"] = 5.0
    assert clean(frame, "t").dropped == {"no range error": 5}


def test_counts_add_up_and_read_well() -> None:
    total = add_counts({"a": 1}, {"b": 5, "a": 2})
    assert total == {"a": 3, "b": 5}
    assert describe(total) == "5 b, 3 a"


def test_obstacles_as_text_are_names_and_not_nothing() -> None:
    cells = pd.Series(["metal rack", "", "wall; door", ["person"], None])
    assert _as_names(cells).tolist() == [["metal rack"], [], ["wall", "door"], ["person"], []]


def test_row_numbers_that_pandas_wrote_along_are_no_columns() -> None:
    frame = _with().assign(**{"__index_level_0__": 1.0, "Unnamed: 0": 2.0, "supply_v": 3.3})
    assert {*clean(frame, "mine").frame} == {*_with(), "supply_v"}


def test_antenna_positions_stand_for_a_true_range_that_is_absent() -> None:
    places = {"tx_x_m": 0.0, "tx_y_m": 0.0, "tx_z_m": 1.0, "rx_x_m": 3.0, "rx_y_m": 4.0}
    rows = pd.DataFrame({"range_m": [5.1, 5.2, 5.3], "link": "a", **places})
    found = clean(rows.assign(rx_z_m=[1.0, 1.0, np.nan]), "t")
    assert found.frame["true_range_m"].tolist() == [5.0, 5.0]
    assert found.dropped == {"no range error": 1}
    with pytest.raises(BenchError, match=r"t: no column 'true_range_m'.*positions"):
        clean(rows, "t")


def test_columns_of_another_kind_are_refused_with_what_they_hold() -> None:
    with pytest.raises(BenchError, match="'range_m' holds true or false; expected numbers"):
        clean(make_frame().assign(range_m=True), "t")
    with pytest.raises(BenchError, match=r"'los' holds '2'; expected true"):
        clean(make_frame().assign(los=2), "t")
