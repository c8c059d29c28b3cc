from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
import result_files as files
from click.testing import CliRunner, Result

from bench.cli.leaderboard import command
from bench.errors import BenchError


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder with `results` in it."""
    run = files.run()
    files.write(tmp_path / "results", run, files.timing(run), files.run("mlp", data="apartment"))
    files.write(tmp_path / "untimed", run)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def call(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments, catch_exceptions=False)


def test_prints_markdown_where_the_output_is_no_terminal(folder: Path) -> None:
    result = call()
    assert result.exit_code == 0
    assert result.stdout.startswith("# Leaderboard\n")
    assert result.stdout.endswith("\n")
    assert "## rooms (SIMULATED), split leave-environment-out:medium" in result.stdout


def test_prints_tables_on_a_terminal(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    result = call()
    assert "| ---" not in result.stdout
    assert "rooms (SIMULATED)" in result.stdout
    assert "remnet" in result.stdout


def test_writes_the_file_it_would_print(folder: Path) -> None:
    printed = call().stdout
    result = call("--out", "deep/BOARD.md")
    assert result.stdout == "wrote deep/BOARD.md\nwrote deep/BOARD-details.md\n"
    written = (folder / "deep" / "BOARD.md").read_text(encoding="utf-8")
    link = "[All columns, devices, versions, what the figures rest on](BOARD-details.md)\n\n"
    assert written.replace(link, "") == printed
    details = (folder / "deep" / "BOARD-details.md").read_text(encoding="utf-8")
    assert details == call("--details").stdout
    (folder / "usual").touch()
    assert (folder / "deep" / "BOARD.md").stat().st_mode == (folder / "usual").stat().st_mode


def test_json_is_all_that_stdout_holds(folder: Path) -> None:
    nan = files.score(r2=files.Interval(float("nan")))
    files.write(folder / "results", files.run("svm", nlos=nan))
    (folder / "results" / "runs" / "bad.json").write_text("{")
    result = call("--json", "--out", "BOARD.md")
    content = json.loads(result.stdout, parse_constant=lambda name: pytest.fail(name))
    rooms = next(board for board in content["boards"] if board["data"] == "rooms")
    by_model = {entry["model"]: entry for entry in rooms["entries"]}
    assert by_model["svm"]["nlos"]["r2"]["value"] is None
    assert by_model["remnet"]["timing"]["latency"][0]["median_us"] == 100.0
    assert content["unreadable"][0]["path"] == "runs/bad.json"
    assert "wrote BOARD.md" in result.stderr


def test_a_plot_is_written_twice_and_shown_in_the_report(folder: Path) -> None:
    result = call("--plot", "figures/front.png", "--out", "docs/BOARD.md")
    assert result.stdout.split() == [
        *("wrote", "figures/front.svg", "wrote", "figures/front.png"),
        *("wrote", "docs/BOARD.md", "wrote", "docs/BOARD-details.md"),
    ]
    assert (folder / "figures" / "front.svg").read_text().startswith("<?xml")
    assert (folder / "figures" / "front.png").read_bytes().startswith(b"\x89PNG")
    assert "](../figures/front.svg)" in (folder / "docs" / "BOARD.md").read_text()


def test_a_plot_of_a_device_shows_its_estimate(folder: Path) -> None:
    result = call("--plot", "front", "--device", "cortex-a53")
    assert "wrote front.svg" in result.stderr
    svg = (folder / "front.svg").read_text(encoding="utf-8")
    assert "<!-- estimated latency of one inference on cortex-a53 (µs, est.) -->" in svg


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--results", "absent"), "no results folder absent"),
        (("--results", "."), r"no results in \.: expected runs/\*\.json"),
        (
            ("--machine", "cray"),
            r"no timings of a machine like 'cray' \(machines: Example CPU 3000, id 0123abcd\)",
        ),
        (("--plot", "a.pdf"), r"--plot a\.pdf: expected a name ending in \.svg or \.png"),
        (("--device", "cortex-a53"), "expected --plot FILE beside it"),
        (("--plot", "a", "--device", "cortexa53"), "did you mean 'cortex-a53'"),
        (("--plot", "a", "--device", "edge-tpu"), "unknown device 'edge-tpu'"),
        (("--results", "untimed", "--plot", "a"), "nothing to plot: .* a measured latency"),
        (("--out", "results"), "cannot write results"),
        (("--out", "results/runs"), "cannot write results/runs"),
    ],
)
def test_bad_input_is_one_clear_line_and_writes_nothing(
    folder: Path, arguments: tuple[str, ...], message: str
) -> None:
    before = sorted(folder.rglob("*"))
    with pytest.raises(BenchError, match=message):
        call(*arguments)
    assert sorted(folder.rglob("*")) == before


def test_the_command_line_ends_in_exit_code_two_and_one_line(folder: Path) -> None:
    run = subprocess.run(
        [
            sys.executable,
            "-c",
            "from bench.cli.main import main; main()",
            "leaderboard",
            "--results",
            "absent",
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr.startswith("bench: no results folder absent")
    assert len(run.stderr.splitlines()) == 1


def test_help_shows_an_example() -> None:
    assert "Example: bench leaderboard" in call("--help").stdout
