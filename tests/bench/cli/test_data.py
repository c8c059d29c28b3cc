from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from recordings_factory import make_frame, make_recordings

from bench.cli import main as cli
from bench.cli.data import command
from bench.errors import BenchError
from bench.recordings import read_recordings, write_recordings


def _run(*arguments: object) -> Result:
    return CliRunner().invoke(command, [str(a) for a in arguments], catch_exceptions=False)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "noise.parquet"
    write_recordings(make_recordings(rows=120, links=12), path)
    return path


def test_list_names_every_data_set_and_how_to_get_it(monkeypatch) -> None:
    monkeypatch.delenv("BENCH_DATA", raising=False)
    result = _run("list")
    for name in ("rooms", "apartment", "ghent", "outdoor", "deepuwb"):
        assert name in result.output
    assert "SIMULATED" in result.output
    assert "bench data fetch deepuwb" in result.output


def test_list_as_json_can_be_read_by_a_program(monkeypatch) -> None:
    monkeypatch.delenv("BENCH_DATA", raising=False)
    rows = {row["name"]: row for row in json.loads(_run("list", "--json").stdout)}
    assert rows["rooms"]["available"] is True
    assert rows["apartment"]["available"] is False
    assert rows["apartment"]["licence"] == "CC-BY-4.0"


def test_listing_imports_nothing_heavy() -> None:
    code = (
        "import sys; from click.testing import CliRunner; from bench.cli.data import command; "
        "assert CliRunner().invoke(command, ['list']).exit_code == 0; "
        "print([m for m in ('torch', 'onnxruntime', 'sklearn', 'matplotlib', 'pyarrow', 'numba', "
        "'pandas') if m in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_info_prints_rows_links_dropped_and_errors(table: Path) -> None:
    result = _run("info", table)
    assert "SIMULATED" in result.output
    for words in ("rows         120", "links        12", "dropped      none", "157 samples of"):
        assert words in result.output
    line = next(line for line in result.output.splitlines() if line.startswith("medium"))
    assert line.split()[1] in ("LoS", "NLoS")
    assert len(line.split()) == 10


def test_info_as_json_holds_the_same_numbers(table: Path) -> None:
    found = json.loads(_run("info", table, "--json").stdout)
    assert (found["rows"], found["links"], found["simulated"]) == (120, 12, True)
    everything = found["errors"][0]
    errors = read_recordings(table).errors_m()
    assert everything["mean_m"] == pytest.approx(errors.mean())
    assert everything["mae_m"] == pytest.approx(abs(errors).mean())
    assert everything["sigma_m"] == pytest.approx(errors.std())
    by_kind = [line for line in found["errors"] if line["environment"] == "all"][1:]
    assert sum(line["rows"] for line in by_kind) == 120


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_info_draws_a_picture(table: Path, tmp_path: Path, ending: str) -> None:
    picture = tmp_path / f"noise.{ending}"
    assert f"picture: {picture}" in _run("info", table, "--plot", picture).output
    magic = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[ending]
    assert picture.read_bytes().startswith(magic)


@pytest.mark.parametrize(
    "change",
    [
        lambda f: f.drop(columns=["cir", "first_path_index"]),
        lambda f: f.drop(columns="first_path_index"),
        lambda f: f.drop(columns=["los", "environment", "link", "obstacles"]),
        lambda f: f.assign(first_path_index=0.5),
        lambda f: f.assign(first_path_index=155.5),
        lambda f: f.head(2),
        lambda f: f.assign(range_m=f["true_range_m"]),
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_sparse_table_can_be_described_and_drawn(tmp_path: Path, change) -> None:
    from bench.recordings import Recordings

    path = tmp_path / "sparse.parquet"
    write_recordings(Recordings(change(make_frame()), "sparse"), path)
    assert _run("info", path, "--plot", tmp_path / "sparse.png").exit_code == 0


def test_import_writes_a_csv_as_parquet_with_what_was_dropped(tmp_path: Path) -> None:
    csv, out = tmp_path / "mine.csv", tmp_path / "mine.parquet"
    csv.write_text("range_m,true_range_m,link\n5.1,5.0,a\n5.2,5.0,b\n,5.0,b\n")
    assert "2 rows of mine; dropped: 1 no range error" in _run("import", csv, "-o", out).output
    read = read_recordings(out)
    assert (len(read), read.source, read.dropped) == (2, "mine", {"no range error": 1})


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("info", "apartmnt"), "did you mean 'apartment'"),
        (("info", "missing.parquet"), "missing.parquet: no such file"),
        (("info", "TABLE", "--plot", "noise.jpg"), "expected a name that ends in .png"),
        (("import", "TABLE", "-o", "out.csv"), "expected a .parquet name"),
        (("import", "TABLE", "-o", "/dev/null/out.parquet"), "cannot write"),
        (("fetch", "rooms"), "nothing to fetch"),
        (("fetch", "ghent"), "download it by hand from https://doi.org/10.1109"),
        (("fetch", "room"), "did you mean 'rooms'"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(table, arguments, expected, monkeypatch, capsys):
    words = [str(table) if word == "TABLE" else word for word in arguments]
    monkeypatch.setattr(sys, "argv", ["bench", "data", *words])
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 2
    error = capsys.readouterr().err
    assert expected in error
    assert len(error.splitlines()) == 1


def test_fetch_says_what_it_got_and_what_comes_next(monkeypatch, tmp_path: Path) -> None:
    def download(source, accept_unverified, sha256, progress):
        assert (accept_unverified, sha256) == (True, "0" * 64)
        progress("dataset.pkl", 10, 20)
        progress("dataset.pkl", 20, 20)
        return [tmp_path / "dataset.pkl"]

    monkeypatch.setattr("bench.recordings.fetch.fetch", download)
    monkeypatch.setattr(
        "bench.recordings.sources.deepuwb.DeepUwbSource.available", lambda self: None
    )
    result = _run("fetch", "deepuwb", "--accept-unverified", "--sha256", "0" * 64)
    assert "deepuwb: 1 files in" in result.output
    assert "bench data info deepuwb" in result.output


def test_fetch_says_where_what_came_is_not_the_data_set(monkeypatch) -> None:
    monkeypatch.setattr("bench.recordings.fetch.fetch", lambda *args: [])
    monkeypatch.delenv("BENCH_DATA", raising=False)
    with pytest.raises(BenchError, match=r"not as expected: dataset\.pkl not found"):
        _run("fetch", "deepuwb")


def test_line_ends_and_tabs_in_names_are_shown_and_not_printed(tmp_path: Path) -> None:
    path = tmp_path / "two\nlines\tand a tab.parquet"
    write_recordings(make_recordings(rows=24, source="so\nurce"), path)
    shown = _run("info", path)
    assert r"so\nurce" in shown.output
    again = _run("import", path, "-o", tmp_path / "o\tut\n.parquet")
    assert again.exit_code == 0
    assert r"o\tut\n.parquet: 24 rows of so\nurce" in again.output
