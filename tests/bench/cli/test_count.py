"""`bench count` on a tiny table: figures, checks, a board's cycles, bad input."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner
from recordings_factory import make_recordings

from bench.cli.count_table import END, START, markdown_table, write_markdown
from bench.cli.count_view import print_rows
from bench.cli.main import group, main
from bench.errors import BenchError
from bench.measure.counting import compile, emulate, find_compiler, load_core
from bench.recordings import write_recordings
from bench.runner.count_models import CountRow


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "tiny.parquet"
    write_recordings(make_recordings(), path)
    return str(path)


@pytest.fixture
def tools():
    try:
        emulate.check_tools()
        find_compiler(load_core("cortex-m4f"))
    except BenchError as problem:
        pytest.skip(str(problem))


def _count(*arguments: str):
    return CliRunner().invoke(group, ["count", *arguments])


def _one_line(monkeypatch, capsys, *arguments: str) -> str:
    monkeypatch.setattr("sys.argv", ["bench", "count", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr().err.strip()
    assert ended.value.code == 2
    assert "\n" not in said
    return said


def test_a_network_is_counted_checked_and_fits(tools, table, tmp_path):
    board = tmp_path / "board.txt"
    board.write_text("row 0: 900000 cycles, 1 um, expected 1 um\n")
    ask = ["--model", "mlp", "--backend", "c-fp32", "--device", "nrf52832", "--data", table]
    ask += ["--rows", "3", "--measured", str(board), "--profile-out", str(tmp_path / "mine.toml")]
    done = _count(*ask, "--markdown", str(tmp_path / "table.md"), "--json")
    assert done.exit_code == 0, done.output
    assert done.stderr == ""
    row = json.loads(done.stdout)[0]
    assert (row["how"], row["count"]["rows"], row["agreement"]["rows"]) == ("counted", 3, 3)
    assert row["agreement"]["largest_m"] <= 0.001
    assert row["measured_cycles"] == [900_000]
    weights = 4 * (6 * 64 + 64 * 64 + 64)
    assert weights < row["count"]["flash_bytes"] < weights + 20_000
    assert row["figure"]["fits"].startswith("fits: ")
    assert row["figure"]["latency_us"]["value"] == pytest.approx(
        row["figure"]["cycles"]["value"] / 64
    )
    markdown = (tmp_path / "table.md").read_text()
    assert "| 3 of 3 |" in markdown
    assert "| nrf52832 | mlp | c-fp32 | measured | 0.9 |" in markdown
    assert "| nrf52832 | mlp | c-fp32 | counted |" in markdown
    again = _count(*ask[:5], str(tmp_path / "mine.toml"), *ask[6:8], "--rows", "3", "--json")
    assert again.exit_code == 0, again.output
    assert json.loads(again.stdout)[0]["figure"]["cycles"]["value"] == pytest.approx(900_000)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--device", "nrf5283"), "did you mean 'nrf52832'"),
        (("--device", "rtx-2080"), "no core to count on"),
        (("--device", "none.toml"), "cannot read device profile none.toml"),
        (("--rows", "0"), "--rows 0: expected a whole number of at least 1"),
        (("--measured", "none.txt"), "cannot read none.txt"),
        (("--device", "cortex-m4"), "is a core, no device: name a part that has it (nrf52832, "),
        (("--markdown", "/dev/null/x.md"), "/dev/null is a file, expected a folder"),
        (("--profile-out", "x.toml"), "--profile-out needs --measured"),
        (("--model", "remnett"), "did you mean 'remnet'"),
    ],
)
def test_bad_input_is_one_line(tools, table, monkeypatch, capsys, arguments, said):
    given = {"--model": "mlp", "--backend": "c-fp32", "--device": "nrf52832", "--data": table}
    given |= dict([arguments])
    flat = [part for pair in given.items() for part in pair]
    assert said in _one_line(monkeypatch, capsys, *flat)


def test_a_table_goes_between_the_marks_of_a_page(tmp_path):
    row = CountRow("model", "c-int8", "part", None, "Model has no | weights", data="mine")
    table = markdown_table([row], None)
    page = tmp_path / "page.md"
    page.write_text(f"# Mine\n{START}\nold\n{END}\nbelow\n")
    write_markdown(page, table)
    assert page.read_text() == f"# Mine\n{START}\n{table}{END}\nbelow\n"
    assert "| part | model | c-int8 | - (Model has no / weights) |" in table
    write_markdown(tmp_path / "new.md", table)
    assert (tmp_path / "new.md").read_text() == table


def test_steps_are_told_and_a_board_far_from_the_count_is_doubted(tools, table, tmp_path):
    (tmp_path / "board.txt").write_text("row 0: 900000 cycles")
    ask = ["--model", "none", "--backend", "fp32", "--device", "nrf52832", "--data", table]
    done = _count(*ask, "--rows", "2", "--measured", str(tmp_path / "board.txt"))
    assert done.exit_code == 0, done.output
    said = "".join(done.stdout.split())  # lines are broken wherever a path is long
    assert f"Countedonrowsof{table}(SIMULATED)" in said
    assert "board.txt:" in said
    assert "timesthecyclescounted:isitofthismodel" in said
    told = done.stderr.splitlines()
    assert told == ["reading the recordings", "fitting none", "counting none on fp32"]


def test_several_networks_cannot_share_a_boards_cycles(tools, table, tmp_path, monkeypatch, capsys):
    (tmp_path / "board.txt").write_text("900000 cycles")
    ask = ["--model", "mlp", "--backend", "c-fp32", "--device", "nrf52832,nrf52840"]
    ask += ["--data", table, "--measured", str(tmp_path / "board.txt")]
    assert "name one each" in _one_line(monkeypatch, capsys, *ask)


def test_the_files_of_finished_runs_are_counted_without_a_fit(tools, table, tmp_path, monkeypatch):
    results = str(tmp_path / "results")
    run = ["run", "--model", "none", "--backend", "fp32,int8", "--data", table, "--no-timing"]
    assert CliRunner().invoke(group, [*run, "--out", results]).exit_code == 0
    monkeypatch.setattr("bench.runner.count_models.fit_fold", None)
    ask = ["--model", "none,mlp", "--backend", "fp32", "--device", "nrf52832", "--data", table]
    done = _count(*ask, "--results", results, "--rows", "2", "--json")
    assert done.exit_code == 0, done.output
    counted, absent = json.loads(done.stdout)
    assert counted["agreement"]["rows"] == counted["agreement"]["equal"] == 2
    assert absent["reason"].startswith("no finished run of mlp on fp32")
    skipped = _count(*ask[:2], "--backend", "fp32,int8", *ask[4:], "--results", results, "--json")
    assert json.loads(skipped.stdout)[1]["reason"] == "NoMitigation has no weights"
    nowhere = _count(*ask, "--results", str(tmp_path))
    assert isinstance(nowhere.exception, BenchError)
    assert "no finished runs here" in str(nowhere.exception)


ASK = ("--model", "mlp", "--backend", "c-fp32", "--device", "nrf52832")


def test_without_an_emulator_one_line_names_the_extra(monkeypatch, capsys):
    monkeypatch.setattr(emulate, "find_spec", lambda _: None)
    said = _one_line(monkeypatch, capsys, *ASK)
    assert said == "bench: counting needs unicorn: pip install 'uwb-bench[count]'"


def test_without_a_compiler_one_line_names_extra_and_package(monkeypatch, capsys):
    monkeypatch.setattr(emulate, "find_spec", lambda _: True)
    monkeypatch.setattr(compile, "find_spec", lambda _: None)
    monkeypatch.setattr(compile.shutil, "which", lambda _: None)
    said = _one_line(monkeypatch, capsys, *ASK)
    assert "uwb-bench[native]" in said
    assert "gcc-arm-none-eabi" in said


def test_why_something_was_not_counted_stands_below_the_table(capsys):
    row = CountRow("model", "c-int8", "part", None, "Model has no weights")
    print_rows([row], None)
    table, _, below = capsys.readouterr().out.partition("counted: instructions")
    assert "not" in table
    assert "no weights" not in table
    assert "model on c-int8, part: not counted: Model has no weights" in below
