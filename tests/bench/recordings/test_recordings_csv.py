from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.errors import BenchError
from bench.recordings import read_recordings


def _write(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("cell", ['"[1, 2.5, 3]"', "1 2.5 3", "1;2.5;3", '"1, 2.5, 3"'])
def test_a_cir_cell_may_be_a_list_or_separated_numbers(tmp_path: Path, cell: str) -> None:
    path = _write(
        tmp_path / "t.csv",
        "range_m,true_range_m,cir,link,los,obstacles",
        f"5.1,5.0,{cell},007,true,wall; glass plate",
        f"5.2,5.0,{cell},007,false,",
        f'5.3,5.0,{cell},008,,"[""wood door""]"',
    )
    read = read_recordings(path)
    np.testing.assert_array_equal(read.frame["cir"].iloc[0], np.float32([1, 2.5, 3]))
    assert read.frame["link"].tolist() == ["007", "007", "008"]
    assert read.frame["obstacles"].tolist() == [["wall", "glass plate"], [], ["wood door"]]
    assert read.frame["los"].isna().tolist() == [False, False, True]
    assert (read.source, read.dropped) == ("t", {})


def test_a_cir_may_stand_in_numbered_columns_in_any_order(tmp_path: Path) -> None:
    header = "error_m," + ",".join(f"cir_{number}" for number in (0, 2, 1, *range(3, 12)))
    rows = ["0.1," + ",".join(str(v) for v in range(12)) for _ in range(3)]
    read = read_recordings(_write(tmp_path / "t.csv", header, *rows))
    assert read.frame["cir"].iloc[0].tolist() == [0, 2, 1, *range(3, 12)]
    assert list(read.frame.columns) == ["error_m", "cir"]


def test_the_complex_accumulator_may_stand_in_numbered_columns(tmp_path: Path) -> None:
    path = _write(tmp_path / "t.csv", "error_m,cir_i_0,cir_i_1,cir_q_0,cir_q_1", "0.1,3,0,4,1")
    assert read_recordings(path).frame["cir"].iloc[0].tolist() == [5.0, 1.0]


def test_unreadable_cells_are_dropped_and_counted(tmp_path: Path) -> None:
    path = _write(tmp_path / "t.csv", "error_m,cir", *["0.1,1 2 3"] * 3, "0.1,abc", "oops,1 2 3")
    read = read_recordings(path)
    assert read.dropped == {"error_m is not a number": 1, "no CIR": 1}


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["error_m,cir_0,cir_2", "0.1,1,2"], "no column 'cir_1'; expected cir_0 to cir_2"),
        (["error_m,cir_0,cir_1", "0.1,1,x"], "column 'cir_1' holds text"),
        (["error_m,error_m", "0.1,1"], "'error_m' stands twice in the header"),
        (["error_m", "0.1,1"], "not a CSV table"),
        (["error_m;link", "0,1;a"], "bench data import finds its delimiter"),
        (["error_m"], "no rows"),
        ([""], "not a CSV table"),
        (["range_m;true_range_m", "1;2"], "bench data import finds its delimiter"),
        (["range_m | link", "1 | a"], "bench data import finds its delimiter"),
    ],
)
def test_a_bad_csv_gives_one_clear_line(tmp_path: Path, lines: list[str], expected: str) -> None:
    with pytest.raises(BenchError) as caught:
        read_recordings(_write(tmp_path / "t.csv", *lines))
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_parquet_of_another_name_and_dates_say_what_is_expected(tmp_path: Path) -> None:
    frame = pd.DataFrame({"range_m": [1.0, 2.0], "true_range_m": [1.0, 2.1], "link": ["a", "b"]})
    frame.to_parquet(tmp_path / "named.csv")
    with pytest.raises(BenchError, match=r"named\.csv: it is Parquet, not CSV: .*\.parquet$"):
        read_recordings(tmp_path / "named.csv")
    dates = frame.assign(time_s=["2026-03-01 01:03:10", "2026-03-01 01:03:11"])
    dates.to_csv(tmp_path / "dates.csv", index=False)
    with pytest.raises(BenchError, match=r"'time_s' holds dates \(the first: 2026-.*seconds"):
        read_recordings(tmp_path / "dates.csv")


GZIP = gzip.compress(b"range_m,true_range_m\n5.1,5.0\n", mtime=0)  # a test's id holds its bytes


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (GZIP, "compressed with gzip.*in .csv.gz"),
        (b"PK\x03\x04 and so on", "a zip archive or a spreadsheet"),
        (b"\x7fELF\0\0\xff\xfe,\xf3", "no text"),
        (b"a,b\n\xff\xfe\xf3\x1b[31m\n\xff,\xf1,\xf2,3\n", "bytes of no text|not a CSV"),
    ],
)
def test_of_a_file_that_is_no_text_no_byte_is_shown(
    tmp_path: Path, content: bytes, said: str
) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(content)
    with pytest.raises(BenchError, match=said) as caught:
        read_recordings(path)
    assert str(caught.value).isascii()
    assert str(caught.value).isprintable()
