from __future__ import annotations

import errno
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from recordings_factory import cells, make_frame, make_recordings

from bench.errors import BenchError
from bench.recordings import Recordings, read_recordings, write_recordings
from bench.recordings.clean import clean


def test_round_trip_keeps_every_value_and_where_it_came_from(tmp_path: Path) -> None:
    made = make_recordings(rows=40)
    made.frame["gain"] = np.arange(40)
    before = Recordings(
        clean(made.frame, "x").frame, "noise", "CC0-1.0", "[base]\n", 7, {"no CIR": 2}
    )
    write_recordings(before, tmp_path / "t.parquet")
    after = read_recordings(tmp_path / "t.parquet")
    pd.testing.assert_frame_equal(before.frame.drop(columns="cir"), after.frame.drop(columns="cir"))
    np.testing.assert_array_equal(np.stack(before.frame["cir"]), np.stack(after.frame["cir"]))
    assert after.fingerprint == before.fingerprint
    assert (after.source, after.licence, after.simulator, after.seed, after.dropped) == (
        "noise",
        "CC0-1.0",
        "[base]\n",
        7,
        {"no CIR": 2},
    )


def test_metadata_is_the_exchange_formats(tmp_path: Path) -> None:
    write_recordings(make_recordings(rows=10, links=2), tmp_path / "t.parquet")
    schema = pq.read_schema(tmp_path / "t.parquet")
    assert schema.metadata[b"recordings_version"] == b"1"
    assert json.loads(schema.metadata[b"dropped"]) == {}
    assert schema.field("cir").type == pa.list_(pa.float32())


@pytest.mark.parametrize(
    "kind", [pa.list_(pa.float64()), pa.large_list(pa.int16()), pa.list_(pa.float32(), 157)]
)
def test_any_list_type_is_read(tmp_path: Path, kind: pa.DataType) -> None:
    frame = make_frame(rows=30)
    values = pa.array([np.round(c).tolist() for c in frame["cir"]], type=pa.list_(pa.float64()))
    table = pa.table(
        {"error_m": frame["range_m"] - frame["true_range_m"], "cir": values.cast(kind)}
    )
    pq.write_table(table, tmp_path / "t.parquet", row_group_size=7)
    read = read_recordings(tmp_path / "t.parquet")
    assert read.source == "t"
    np.testing.assert_array_equal(np.stack(read.frame["cir"]), np.round(np.stack(frame["cir"])))


def test_null_and_ragged_cirs_are_dropped_and_counted(tmp_path: Path) -> None:
    lists = [[1.0, 2.0, 3.0]] * 6 + [None, [1.0, 2.0], [1.0, None, 2.0], [0.0, 0.0, 0.0]]
    pq.write_table(pa.table({"error_m": [0.1] * 10, "cir": lists}), tmp_path / "t.parquet")
    read = read_recordings(tmp_path / "t.parquet")
    assert len(read) == 6
    assert read.dropped == {
        "no CIR": 1,
        "CIR not of length 3": 1,
        "NaN in the CIR": 1,
        "CIR zero throughout": 1,
    }


def test_what_was_dropped_before_is_added_to_what_is_dropped_now(tmp_path: Path) -> None:
    frame = pd.DataFrame({"error_m": [0.1, 0.2, np.nan]})
    write_recordings(Recordings(frame, "x", dropped={"no range error": 4}), tmp_path / "t.parquet")
    assert read_recordings(tmp_path / "t.parquet").dropped == {"no range error": 5}


def _no_parquet(path: Path) -> None:
    path.write_text("hello, I am no table at all")


def _truncated(path: Path) -> None:
    write_recordings(make_recordings(), path)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def _damaged(path: Path) -> None:
    write_recordings(make_recordings(), path)
    content = bytearray(path.read_bytes())
    content[-40:-8] = b"\xff" * 32
    path.write_bytes(bytes(content))


def _empty_table(path: Path) -> None:
    pq.write_table(pa.table({"error_m": pa.array([], pa.float64())}), path)


def _no_truth(path: Path) -> None:
    pq.write_table(pa.table({"range_m": [1.0]}), path)


def _scalar_cir(path: Path) -> None:
    pq.write_table(pa.table({"error_m": [1.0], "cir": [1.0]}), path)


def _empty_cir(path: Path) -> None:
    empty = pa.array([], pa.null())  # as pandas writes no rows of lists
    pq.write_table(pa.table({"error_m": pa.array([], pa.float64()), "cir": empty}), path)


def _all_nan(path: Path) -> None:
    pq.write_table(pa.table({"error_m": [np.nan, np.nan]}), path)


def _all_nan_cir(path: Path) -> None:
    pq.write_table(pa.table({"error_m": [0.1, 0.2], "cir": [[np.nan] * 3] * 2}), path)


def _inconsistent(path: Path) -> None:
    lists = [list(range(1, n + 2)) for n in range(6)]
    pq.write_table(pa.table({"error_m": [0.1] * 6, "cir": lists}), path)


def _later_version(path: Path) -> None:
    table = pa.table({"error_m": [1.0]}).replace_schema_metadata({"recordings_version": "9"})
    pq.write_table(table, path)


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda path: None, "no such file"),
        (lambda path: path.mkdir(), "not a regular file"),
        (_no_parquet, "not a Parquet file"),
        (lambda path: path.write_bytes(b""), "not a Parquet file"),
        (_truncated, "truncated Parquet"),
        (_damaged, "damaged Parquet"),
        (_empty_table, "no rows"),
        (_empty_cir, "no rows"),
        (_no_truth, "no column 'true_range_m'; expected"),
        (_scalar_cir, "column 'cir' holds double; expected lists of numbers"),
        (_all_nan, "'error_m' holds no number"),
        (_all_nan_cir, "2 of 2 rows are unusable (2 NaN in the CIR)"),
        (_inconsistent, "5 of 6 rows are unusable (5 CIR not of length"),
        (_later_version, "recordings_version '9'"),
    ],
)
def test_a_bad_file_gives_one_clear_line(tmp_path: Path, make, expected: str) -> None:
    path = tmp_path / "bad.parquet"
    make(path)
    with pytest.raises(BenchError) as caught:
        read_recordings(path)
    assert expected in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_kind_of_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "t.xlsx").write_text("x")
    with pytest.raises(BenchError, match=r"expected \.parquet or \.csv"):
        read_recordings(tmp_path / "t.xlsx")


def test_writing_leaves_nothing_where_the_disk_is_full(tmp_path: Path, monkeypatch) -> None:
    def full(*args, **options):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(pq.ParquetWriter, "write_table", full)
    with pytest.raises(BenchError, match="No space left"):
        write_recordings(make_recordings(), tmp_path / "t.parquet")
    assert list(tmp_path.iterdir()) == []


def test_text_alone_is_written_by_dictionary_and_samples_without_extremes(tmp_path: Path) -> None:
    write_recordings(make_recordings(), tmp_path / "t.parquet")
    group = pq.ParquetFile(tmp_path / "t.parquet").metadata.row_group(0)
    columns = {c.path_in_schema: c for c in map(group.column, range(group.num_columns))}
    by_dictionary = {n for n, c in columns.items() if "RLE_DICTIONARY" in c.encodings}
    assert "link" in by_dictionary
    assert not any(n.endswith("_m") or n.startswith("cir") for n in by_dictionary)
    assert columns["range_m"].statistics is not None
    cir = next(column for name, column in columns.items() if name.startswith("cir"))
    assert cir.statistics is None


def test_writing_refuses_a_name_that_is_no_parquet(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match=r"expected a \.parquet name"):
        write_recordings(make_recordings(), tmp_path / "t.csv")


def test_an_empty_cir_column_can_be_written_and_is_refused_on_reading(tmp_path: Path) -> None:
    frame = pd.DataFrame({"error_m": np.zeros(3), "cir": cells(np.zeros((3, 0)))})
    write_recordings(Recordings(frame, "x"), tmp_path / "t.parquet")
    with pytest.raises(BenchError, match="3 no CIR"):
        read_recordings(tmp_path / "t.parquet")
