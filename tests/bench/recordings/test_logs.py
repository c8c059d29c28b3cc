"""Somebody's own logs: marks, mapping and units, registers, links, warnings, folders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.errors import BenchError
from bench.recordings.dw1000 import first_path_power_dbm, receive_power_dbm
from bench.recordings.logs.dialect import Dialect, find_dialect
from bench.recordings.logs.links import MISSING, make_links
from bench.recordings.logs.read import LogOptions, read_logs
from bench.recordings.logs.suspicions import suspicions
from bench.recordings.logs.units import converter

GERMAN = (
    "Zeit;Sender;Empfänger;Gemessen;Abstand;Sicht\n"
    "0,5;A;1;5123,4;500,0;ja\n1,5;A;1;5133,4;500,0;nein\n2,5;A;2;7123,4;700,0;ja\n"
)
GERMAN_MAPS = (
    "range=Gemessen:mm,true_range=Abstand:cm,los=Sicht,time=Zeit:s",
    "tx=Sender,rx=Empfänger",
)
PLAIN = "range_m,true_range_m,link\n5.1,5.0,a\n5.2,5.0,b\n"


def _put(path: Path, text: str, encoding: str = "utf-8") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_semicolons_decimal_commas_and_umlauts_are_found(tmp_path: Path, encoding: str) -> None:
    path = _put(tmp_path / "messung.csv", GERMAN, encoding)
    read = read_logs(path, LogOptions(maps=GERMAN_MAPS, link=("Sender", "rx")))
    frame = read.recordings.frame
    assert read.recordings.errors_m() == pytest.approx([0.1234, 0.1334, 0.1234])
    assert frame["time_s"].tolist() == [0.5, 1.5, 2.5]
    assert frame["los"].tolist() == [True, False, True]
    assert frame["link"].tolist() == ["A | 1", "A | 1", "A | 2"]
    assert read.warnings == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a,b\n1.5,2\n", Dialect(",", ".")),
        ("# logger 7\n\na\tb\n1,5\t2\n", Dialect("\t", ",", skip=2)),
        ("a|b\n1.5|2\n", Dialect("|", ".")),
        ("a  b c\n1.5 2   3\n", Dialect(" ", ".")),
        ("a;b\n1.5;2\n", Dialect(";", ".")),
        ("a,cir\n1.5,1;2;3\n2.5,4;5;6\n", Dialect(",", ".")),
        ('a,b\n"1;5",2\n', Dialect(",", ".")),
    ],
)
def test_marks_are_found(tmp_path: Path, text: str, expected: Dialect) -> None:
    assert find_dialect(_put(tmp_path / "log.txt", text)) == expected


def test_marks_that_are_given_decide(tmp_path: Path) -> None:
    path = _put(tmp_path / "log.csv", GERMAN)
    assert find_dialect(path, ";,") == Dialect(";", ",")
    assert find_dialect(path, "tab.").delimiter == "\t"


def test_a_cir_with_decimal_commas_and_one_in_numbered_columns(tmp_path: Path) -> None:
    cell = _put(tmp_path / "cell.csv", "r;t;link;Impuls\n5,1;5,0;a;1,5 2,5 3,5\n5,2;5,0;b;4 5 6\n")
    maps = ("range=r,true_range=t,cir=Impuls",)
    frame = read_logs(cell, LogOptions(maps=maps)).recordings.frame
    assert [list(cir) for cir in frame["cir"]] == [[1.5, 2.5, 3.5], [4, 5, 6]]
    wide = _put(tmp_path / "wide.csv", "r,t,link,Impuls_0,Impuls_1\n5.1,5.0,a,1,2\n")
    frame = read_logs(wide, LogOptions(maps=maps)).recordings.frame
    assert [list(cir) for cir in frame["cir"]] == [[1, 2]]
    assert set(frame) == {"range_m", "true_range_m", "link", "cir"}


def test_text_among_numbers_is_dropped_and_counted_not_repaired(tmp_path: Path) -> None:
    text = "d;t;link\n5100,5;5,0;a\n-;5,0;a\n;5,0;a\n5200;5,0;b\n5300;5,0;b\n"
    path = _put(tmp_path / "log.csv", text)
    recordings = read_logs(path, LogOptions(maps=("range=d:mm,true_range=t",))).recordings
    assert recordings.frame["range_m"].tolist() == pytest.approx([5.1005, 5.2, 5.3])
    assert recordings.dropped == {"range_m is not a number": 1, "no range error": 1}


@pytest.mark.parametrize(
    ("column", "unit", "given", "expected"),
    [
        ("range_m", "mm", 5100.0, 5.1),
        ("true_range_m", "ft", 10.0, 3.048),
        ("rx_power_dbm", "mW", 1e-8, -80.0),
        ("rx_power_dbm", "mW", 0.0, -np.inf),
        ("temperature_c", "K", 300.0, 26.85),
        ("reply_time_s", "dw_tick", 128 * 499.2e6, 1.0),
        ("clock_offset_ppm", "ppb", 2500.0, 2.5),
        ("first_path_index", "10.6", 47800.0, 746.875),
        ("azimuth_deg", "rad", np.pi, 180.0),
    ],
)
def test_units(column: str, unit: str, given: float, expected: float) -> None:
    assert converter(column, unit, "x")(np.array([given]))[0] == pytest.approx(expected)


@given(st.floats(-1e6, 1e6))
@settings(deadline=None)  # the first call reads the registry of units
def test_millimetres_and_back(length: float) -> None:
    there = converter("range_m", "mm", "x")(np.array([length]))
    assert converter("range_m", "km", "x")(there / 1e3)[0] * 1e3 == pytest.approx(length)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"maps": ("range=Gemessen:mmm",)}, "--map range=Gemessen:mmm: unknown unit 'mmm'; expect"),
        ({"maps": ("range=Gemessen:s",)}, "'s' is no length; expected a length such as m, cm"),
        ({"maps": ("range=Gemessen:__import__('os')",)}, "unknown unit"),
        ({"maps": ("range=Gemesen:mm",)}, "no column 'Gemesen' in"),
        ({"maps": ("range=Gemesen:mm",)}, "did you mean 'Gemessen'?"),
        ({"maps": ("range=Gemessen,range=Abstand",)}, "'Gemessen' and 'Abstand' are both mapped"),
        ({"maps": ("range=Gemessen", "range_m=Abstand")}, "are both mapped to range_m"),
        ({"maps": ("rnge=Gemessen",)}, "unknown column of the exchange format 'rnge'; did you"),
        ({"maps": ("range",)}, "--map range: expected NAME=COLUMN or NAME=COLUMN:UNIT"),
        ({"maps": ("los=Zeit:not",)}, "'Zeit' holds"),
        ({"maps": ("preamble_count=Zeit:s",)}, "preamble_count has no unit"),
        ({"csv": "ab"}, "--csv 'ab': expected the field delimiter and the decimal mark"),
        ({"csv": ";,"}, "no column 'range_m'; say which column it is and its unit"),
        ({"csv": ","}, "not a CSV table: CSV parse error: Expected 1 columns"),
        ({"from_name": "(", "csv": ";,"}, "--from-name (:"),
        ({"from_name": "x", "csv": ";,"}, "nothing named found in messung.csv"),
    ],
)
def test_bad_options_are_one_clear_line(tmp_path: Path, options: dict, expected: str) -> None:
    path = _put(tmp_path / "messung.csv", GERMAN)
    with pytest.raises(BenchError) as caught:
        read_logs(path, LogOptions(**options))
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "empty; expected a header line"),
        ("1;2\n3;4\n", "line 1 holds numbers; expected the names of the columns"),
        ("a;b\0\n", "binary; expected a text table"),
        ("range_m,range_m\n1,2\n", "column 'range_m' stands twice"),
        ("range_m,true_range_m\n1,2\n1,2,3\n", "not a CSV table: CSV parse error"),
    ],
)
def test_bad_files_are_one_clear_line(tmp_path: Path, text: str, expected: str) -> None:
    with pytest.raises(BenchError) as caught:
        read_logs(_put(tmp_path / "log.csv", text))
    assert expected in str(caught.value)


def test_a_new_name_that_is_taken_is_refused(tmp_path: Path) -> None:
    path = _put(tmp_path / "log.csv", PLAIN.replace("link", "d"))
    with pytest.raises(BenchError, match="has a column 'range_m' of its own"):
        read_logs(path, LogOptions(maps=("range=d:mm",)))


def test_registers_become_first_path_and_levels(tmp_path: Path) -> None:
    header = "range_m,true_range_m,link,FP_INDEX,Fp Ampl1,fp_ampl2,FPAMPL3,CIR_PWR,RXPACC,STD_NOISE"
    path = _put(tmp_path / "log.csv", f"{header}\n5.1,5.0,a,47800,5000,6000,5500,9000,1010,48\n")
    read = read_logs(path)
    row = read.recordings.frame.iloc[0]
    assert row["first_path_index"] == 746.875
    assert row["rx_power_dbm"] == pytest.approx(float(receive_power_dbm(9000.0, 1010.0)))
    level = first_path_power_dbm((5000.0, 6000.0, 5500.0), 1010.0)
    assert row["first_path_power_dbm"] == pytest.approx(float(level))
    assert row[["preamble_count", "noise_std", "fp_ampl2", "cir_power"]].tolist() == [
        1010.0, 48.0, 6000.0, 9000.0,
    ]  # fmt: skip
    assert "rx_power_dbm from CIR_PWR, RXPACC" in read.notes


def test_registers_small_enough_are_samples_and_levels_given_stay(tmp_path: Path) -> None:
    text = (
        "range_m,true_range_m,FP_INDEX,rx_power_dbm,CIR_PWR,RXPACC\n5.1,5.0,746.5,-80,9000,1010\n"
    )
    row = read_logs(_put(tmp_path / "log.csv", text)).recordings.frame.iloc[0]
    assert row[["first_path_index", "rx_power_dbm"]].tolist() == [746.5, -80.0]


def _moving() -> pd.DataFrame:
    return pd.DataFrame(
        {"tx": ["a", "b", "a", "a"], "rx": ["b", "a", "b", None], "time_s": [0.0, 9.0, 31.0, 1.0],
         "tx_x_m": [0.1, 0.2, 0.6, 0.1]}
    )  # fmt: skip


@pytest.mark.parametrize(
    ("columns", "rule", "expected"),
    [
        ((), None, None),
        (("tx",), None, ["a", "b", "a", "a"]),
        (("tx", "rx"), None, ["a | b", "b | a", "a | b", None]),
        ((), "time:10s", ["a-b | 0 s", "a-b | 0 s", "a-b | 30 s", None]),
        ((), "time:0.5min", ["a-b | 0 s", "a-b | 0 s", "a-b | 30 s", None]),
        (("tx",), "grid:50cm", ["a | 0 m", "b | 0 m", "a | 0.5 m", "a | 0 m"]),
    ],
)
def test_links_from_columns_time_and_place(columns, rule, expected) -> None:
    made = make_links(_moving(), columns, rule, "log")
    assert (made if made is None else made.astype(object).where(made.notna(), None).tolist()) == (
        expected
    )


@pytest.mark.parametrize(
    ("columns", "rule", "expected"),
    [
        (("place",), None, "--link place: no column 'place' in log"),
        ((), "minute:1", "--link-by minute:1: expected time:DURATION or grid:LENGTH"),
        ((), "time:1m", "'m' is no time"),
        ((), "time:0s", "expected a size above zero"),
        ((), "time:fast", "expected a size such as 20s"),
    ],
)
def test_bad_link_rules(columns, rule, expected: str) -> None:
    with pytest.raises(BenchError, match=expected.replace("(", r"\(")):
        make_links(_moving(), columns, rule, "log")


def test_a_missing_link_is_said_at_import(tmp_path: Path) -> None:
    text = PLAIN.replace(",link", "").replace(",a", "").replace(",b", "")
    assert read_logs(_put(tmp_path / "log.csv", text)).warnings == [MISSING]
    assert read_logs(_put(tmp_path / "linked.csv", PLAIN)).warnings == []


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        ({"range_m": [5100.0], "true_range_m": [5000.0]}, "probably millimetres (or centimetres)"),
        ({"range_m": [400.0], "true_range_m": [0.39]}, "range=COLUMN:mm"),
        ({"range_m": [5.1], "true_range_m": [500.0]}, "true_range=COLUMN:cm"),
        ({"range_m": [16.4], "true_range_m": [5.0]}, "probably feet"),
        ({"error_m": [120.0]}, "error=COLUMN:mm"),
        ({"range_m": [5.1, 4.0], "true_range_m": [5.1, 4.0]}, "there is no error to learn"),
        ({"first_path_index": [47800.0]}, "first_path_index=COLUMN:10.6"),
        ({"rx_power_dbm": [81.0]}, "a sign lost"),
        ({"rssi": [-np.inf, -80.0]}, "column 'rssi' holds 1 infinite value(s); probably a level"),
        ({"first_path_index": [371.0], "cir": [np.ones(157)]}, "10.6 fixed point"),
        ({"first_path_index": [746.4], "cir": [np.ones(157)]}, "the CIR is a window of it"),
        ({"Impuls": [" ".join(["12"] * 40)]}, "--map cir=Impuls"),
        (
            {"range_m": [5.0, 4.3], "true_range_m": [5.0, 5.0], "los": [True, False]},
            "without line of sight ranges read -0.70 m, with it 0.00 m (median errors)",
        ),
        ({"error_m": [-0.1, 0.3], "range_m": [5.1, 4.7], "true_range_m": [5.0, 5.0]}, "leave it"),
    ],
)
def test_likely_causes_are_named(columns: dict, expected: str) -> None:
    assert expected in "; ".join(suspicions(pd.DataFrame(columns)))


def test_nothing_is_suspected_of_a_good_table() -> None:
    good = {"range_m": [5.1, 3.0], "true_range_m": [5.0, 2.9], "first_path_index": [746.0, 5.2],
            "rx_power_dbm": [-80.0, -95.0], "rssi": [-80.0, np.nan], "los": [True, False],
            "note": ["run 1 of 2, 3 m", "no 4"]}  # fmt: skip
    assert suspicions(pd.DataFrame(good)) == []


DATES = """Zeit;Gemessen;Abstand;link
2026-03-01 08:00:01,250;5,1;5,0;a
2026-03-01T08:00:03;5,2;5,0;a
;5,2;5,0;b
"""


def test_dates_become_seconds_since_the_first(tmp_path: Path) -> None:
    log, maps = _put(tmp_path / "log.csv", DATES), "range=Gemessen:m,true_range=Abstand:m,time=Zeit"
    frame = read_logs(log, LogOptions((f"{maps}:date",))).recordings.frame
    np.testing.assert_allclose(frame["time_s"], [0.0, 1.75, np.nan])
    with pytest.raises(BenchError, match="dates such as 2026-03-01 08:00:01,250: --map time=C"):
        read_logs(log, LogOptions((maps,)))
    log.write_text(DATES.replace("2026-03-01T", "1.3.2026 "))
    with pytest.raises(BenchError, match=r"'Zeit' holds '1.3.2026 08:00:03'; expected dates such"):
        read_logs(log, LogOptions((f"{maps}:date",)))


def test_a_length_that_is_no_number_is_shown(tmp_path: Path) -> None:
    text = "Gemessen;Abstand;link\n1.231,5;1.200,0;a\n1.232,5;1.200,0;a\n"
    maps = ("range=Gemessen:mm,true_range=Abstand:mm",)
    with pytest.raises(BenchError, match=r"\(the first: '1.231,5'\); expected metres, without"):
        read_logs(_put(tmp_path / "log.csv", text), LogOptions(maps))


def test_what_makes_most_rows_unusable_is_said_with_its_cause(tmp_path: Path) -> None:
    text = "range_m,true_range_m,cir,first_path_index,link\n5.1,5.0,1 2 3,47800,a\n"
    with pytest.raises(BenchError, match=r"first path outside the CIR.*10\.6 fixed point"):
        read_logs(_put(tmp_path / "log.csv", text))


def test_a_folder_is_one_table_with_file_and_folder(tmp_path: Path) -> None:
    root = tmp_path / "logs"
    for place, size in (("los/2m.csv", 2100), ("los/4m.csv", 4100), ("nlos/4m.csv", 4300)):
        _put(root / place, f"dist;node\n{size};A\n{size};B\n")
    _put(root / ".hidden" / "x.csv", "other\n1\n")
    _put(root / "notes.md", "no table")
    (tmp_path / "outside.csv").write_text("dist;node\n1;A\n")
    (root / "sneaky.csv").symlink_to(tmp_path / "outside.csv")
    options = LogOptions(
        maps=("range=dist:mm,true_range=d:m,los=folder,environment=folder",),
        link=("file",),
        from_name=r"(?P<d>[\d.]+)m\.csv",
    )
    frame = read_logs(root, options).recordings.frame
    assert frame["true_range_m"].tolist() == [2.0, 2.0, 4.0, 4.0, 4.0, 4.0]
    assert frame["link"].unique().tolist() == ["los/2m", "los/4m", "nlos/4m"]
    assert frame["los"].tolist() == [True] * 4 + [False] * 2


def test_a_folder_of_different_forms_is_refused(tmp_path: Path) -> None:
    _put(tmp_path / "a.csv", PLAIN)
    _put(tmp_path / "b.csv", PLAIN.replace("link", "pair"))
    with pytest.raises(BenchError, match=r"b\.csv: no column 'link', unlike a\.csv"):
        read_logs(tmp_path)
    with pytest.raises(BenchError, match="no text tables; expected files ending in"):
        read_logs(_put(tmp_path / "sub" / "x.md", "").parent)


def test_names_that_differ_in_case_alone_are_ours_and_said(tmp_path: Path) -> None:
    text = "RANGE_M,True_Range_m,CIR,LOS,Link,Note\n5.1,5.0,1 2 9,1,a,x\n5.2,5.0,1 3 9,0,b,y\n"
    read = read_logs(_put(tmp_path / "log.csv", text))
    frame = read.recordings.frame
    assert frame["cir"][1].tolist() == [1, 3, 9]
    assert frame["los"].tolist() == [True, False]
    assert {"range_m", "true_range_m", "link", "Note"} <= set(frame)
    assert "cir from 'CIR', whose name differs in case alone" in read.notes


def test_case_is_left_where_two_would_be_one_or_the_user_named_it(tmp_path: Path) -> None:
    text = "range_m,true_range_m,Link,LINK,TX,cir_0,CIR_1\n5.1,5.0,a,b,c,1,2\n5.2,5.0,a,b,d,1,2\n"
    path = _put(tmp_path / "log.csv", text.replace("cir_0", "CIR_0"))
    read = read_logs(path, LogOptions(maps=("environment=TX",)))
    assert {"Link", "LINK", "environment", "cir"} <= set(read.recordings.frame)
    assert sum("case alone" in note for note in read.notes) == 1  # one CIR, not its samples


def test_ragged_lines_are_named_with_the_option_that_helps(tmp_path: Path) -> None:
    text = "range_m;true_range_m;link\n5,1;5,0;a\n5,2;5,0\n5,3;5,0;b;c\n"
    with pytest.raises(BenchError, match=r"2 of 3 lines.*first: '5,2;5,0'.*--csv ';,'"):
        read_logs(_put(tmp_path / "log.csv", text))


def test_lengths_no_radio_ever_reaches_name_the_unit_as_the_cause(tmp_path: Path) -> None:
    path = _put(tmp_path / "log.csv", PLAIN)
    far = LogOptions(maps=("range=range_m:parsec,true_range=true_range_m:parsec",))
    with pytest.raises(BenchError, match=r"range_m: median 1\.\d+e\+17 m.*probably a wrong unit"):
        read_logs(path, far)
    near = LogOptions(maps=("range=range_m:um,true_range=true_range_m:um",))
    assert any("probably a wrong unit" in line for line in read_logs(path, near).warnings)


@pytest.mark.filterwarnings("error::pandas.errors.PerformanceWarning")
def test_a_wide_log_is_read_without_a_word_of_pandas(tmp_path: Path) -> None:
    names = ["range_m", "true_range_m", "link", "FP_INDEX", "STD_NOISE", "RXPACC", "CIR_PWR"]
    names += [f"K_{sample}" for sample in range(157)]
    row = ",".join(["5.1", "5.0", "a", "47000", "40", "118", "9000", *["7"] * 157])
    path = _put(tmp_path / "wide.csv", f"{','.join(names)}\n{row}\n{row}\n")
    frame = read_logs(path, LogOptions()).recordings.frame
    assert frame["first_path_index"].tolist() == [47000 / 64] * 2
    with pytest.raises(BenchError) as problem:
        read_logs(path, LogOptions(maps=("cir=KK",)))
    assert "it has 164 columns, the nearest by name: K_" in str(problem.value)
    assert len(str(problem.value)) < 300


def test_a_pattern_that_is_none_says_what_was_expected(tmp_path: Path) -> None:
    path = _put(tmp_path / "messung.csv", PLAIN)
    with pytest.raises(BenchError, match=r"unterminated .* expected a regular expression"):
        read_logs(path, LogOptions(from_name="([0-9"))
