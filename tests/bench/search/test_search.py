"""`bench search` on a tiny table: a front with REMnet on it, gone on with, and bad input."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from recordings_factory import make_recordings

from bench.cli.main import group, main
from bench.errors import BenchError
from bench.measure.counting import emulate, find_compiler, load_core
from bench.recordings import write_recordings

FEW = ["--candidates", "2", "--finalists", "1", "--levels", "1", "--epochs", "1"]
FEW += ["--final-epochs", "1", "--calibrate", "4"]


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "tiny.parquet"
    write_recordings(make_recordings(rows=120, links=12), path)
    return str(path)


@pytest.fixture
def tools():
    try:
        emulate.check_tools()
        find_compiler(load_core("cortex-m4f"))
    except BenchError as problem:
        pytest.skip(str(problem))


def _search(*arguments: str):
    return CliRunner().invoke(group, ["search", *arguments])


def test_a_search_is_counted_written_and_gone_on_with(tools, table, tmp_path):
    page, out = tmp_path / "front.md", tmp_path / "results"
    asked = ["--data", table, "--out", str(out), *FEW, "--page", str(page)]
    done = _search(*asked, "--json")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert len(found["tried"]) == 2
    names = [one["name"] for one in found["tried"] if one["finalist"]]
    assert {*found["finals"], *found["declined"]} == {"remnet", *names}
    assert all(one["cycles"]["value"] > 1000 for one in found["finals"].values())
    assert all(one["rows"] == one["equal"] == 4 for one in found["finals"].values())
    remnet = found["finals"]["remnet"]["cycles"]["value"]
    assert remnet == pytest.approx(1.0e6, rel=0.2)
    text = page.read_text()
    assert "(SIMULATED)" in text
    assert "COUNTED on nrf52832" in text
    assert names[0] in text.replace("\\", "")
    assert (tmp_path / "front" / "front.png").stat().st_size > 5000

    points = out / "reproduction" / "tiny" / "points"
    before = {one.name: one.stat().st_mtime_ns for one in points.iterdir()}
    again = _search(*asked, "--json")
    assert again.exit_code == 0, again.output
    assert json.loads(again.stdout)["finals"] == found["finals"]
    assert {one.name: one.stat().st_mtime_ns for one in points.iterdir()} == before
    assert len(before) >= 2 + 4 + 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--candidates", "1"), "--candidates 1: expected a whole number from 2"),
        (("--finalists", "40"), "--finalists 40: expected at most --candidates 36"),
        (("--epochs", "0"), "--epochs 0: expected a whole number of at least 1"),
        (("--device", "nrf5283"), "did you mean 'nrf52832'"),
        (("--device", "rtx-2080"), "no core to count on"),
        (("--data", "nothing"), "nothing"),
        (("--page", "front.txt"), "--page front.txt: expected a name that ends in .md"),
        (("--jobs", "0"), "--jobs 0"),
    ],
)
def test_bad_input_is_one_line(tools, monkeypatch, capsys, tmp_path, arguments, said):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["bench", "search", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    *steps, line = capsys.readouterr().err.strip().splitlines()
    assert (ended.value.code, line.startswith("bench: ")) == (2, True)
    assert set(steps) <= {"reading the recordings"}
    assert said in line
    assert list(Path(tmp_path).iterdir()) == []
