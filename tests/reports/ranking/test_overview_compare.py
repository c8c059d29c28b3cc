"""The short leaderboard and `bench compare`, on folders with predictions of a known order."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import result_files as files
from click.testing import CliRunner

from bench.cli.compare import command
from bench.errors import BenchError
from bench.results import to_json
from reports import ReportError, make_boards, read_results
from reports.markdown import to_markdown
from reports.overview import overview, ranked
from reports.ranking.compare import compare
from reports.ranking.picture import tie_groups
from reports.ranking.predictions import compared

LINKS, ROWS = 30, 10


def predictions(folder: Path, name: str, spread_m: float, seed: int = 0, los: int = 0) -> None:
    """Errors known to all models; a model leaves `spread_m` of them, differently per link."""
    shared = np.random.default_rng(1)
    links = np.repeat(np.arange(LINKS), ROWS)
    error = shared.gamma(2.0, 0.1, LINKS)[links]
    own = np.random.default_rng(seed)
    left = spread_m * (1 + 0.2 * own.standard_normal(LINKS)[links])
    table = pd.DataFrame({"row": np.arange(len(links)), "link": links.astype(str)})
    table["error_m"], table["predicted_m"] = error, error - left
    table["scored_as_los"] = links < los
    (folder / "predictions").mkdir(exist_ok=True)
    table.to_parquet(folder / "predictions" / f"{name}.parquet")


def folder_of(path: Path, spreads: dict[str, float], **changes: Any) -> Path:
    """A result folder with a run and its predictions for every model."""
    records = [files.run(model, **changes) for model in spreads]
    (path / "runs").mkdir(parents=True)
    for record in records:
        (path / "runs" / f"{record.key.digest()}.json").write_text(to_json(record))
    for number, (record, spread) in enumerate(zip(records, spreads.values(), strict=True)):
        predictions(path, record.key.digest(), spread, seed=number)
    return path


def test_the_short_leaderboard_has_ten_columns_ranks_and_ties(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, {"good": 0.02, "same": 0.0201, "bad": 0.2})
    results = read_results(folder)
    boards = [ranked(board, results) for board in make_boards(results)]
    text = to_markdown(overview(boards, "details.md"))
    header, _, *rows = [line for line in text.splitlines() if line.startswith("|")]
    assert len(header.strip("|").split("|")) == 10
    cells = {row.split("|")[2].strip(): [c.strip() for c in row.split("|")] for row in rows}
    assert cells["good"][1] == cells["same"][1] == "**1-2**"
    assert cells["bad"][1] == "3"
    assert cells["good"][5] == cells["same"][5] != cells["bad"][5]
    assert "(SIMULATED)" in text
    assert "(details.md)" in text


def test_a_model_without_predictions_is_named_and_not_ranked(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, {"good": 0.02, "bad": 0.2, "mute": 0.1})
    results = read_results(folder)
    mute = next(run for run in results.runs if run.key.model == "mute")
    path = folder / "predictions" / f"{mute.file}.parquet"
    path.write_bytes(b"PAR1 not really")
    board = make_boards(results)[0]
    found = compared(board, results.folder)
    assert list(found.left_out) == ["mute/fp32"]
    assert "Not ranked: mute/fp32." in to_markdown(overview([ranked(board, results)]))


def test_folders_without_predictions_have_a_table_without_ranks(tmp_path: Path) -> None:
    files.write(tmp_path, files.run("remnet"), files.run("svm"))
    results = read_results(tmp_path)
    text = to_markdown(overview([ranked(board, results) for board in make_boards(results)]))
    assert "No ranks: no two models with predictions of the same rows." in text


def test_two_folders_are_compared_run_by_run(tmp_path: Path) -> None:
    before = folder_of(tmp_path / "before", {"remnet": 0.1, "svm": 0.2})
    after = folder_of(tmp_path / "after", {"remnet": 0.05, "svm": 0.2, "new": 0.1})
    found = compare(before, after)
    by_name = {one.first.entry.model: one for one in found.differences if one.rows == "NLoS"}
    better = by_name["remnet"]
    assert better.difference_m.value == pytest.approx(-0.05, abs=0.005)
    assert better.difference_m.high < 0
    assert better.p < 0.01
    assert by_name["svm"].p == 1.0
    assert any("new/fp32" in text and "only in" in text for text in found.refused)


def test_other_recordings_are_refused_by_name(tmp_path: Path) -> None:
    before = folder_of(tmp_path / "before", {"remnet": 0.1, "svm": 0.1})
    after = folder_of(tmp_path / "after", {"remnet": 0.1}, data_fingerprint="f00d")
    with pytest.raises(ReportError, match=r"other recordings .* f00d"):
        compare(before, after)


def test_two_records_are_compared_as_they_are(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, {"remnet": 0.1, "svm": 0.2})
    paths = {
        run.key.model: folder / "runs" / f"{run.file}.json" for run in read_results(folder).runs
    }
    found = compare(paths["remnet"], paths["svm"])
    assert found.differences[0].difference_m.value == pytest.approx(0.1, abs=0.01)


def test_timings_of_another_machine_are_refused(tmp_path: Path) -> None:
    for name, machine in (("a", files.MACHINE), ("b", {**files.MACHINE, "id": "ffff"})):
        folder = folder_of(tmp_path / name, {"remnet": 0.1})
        files.write(folder, files.timing(files.run("remnet"), machine=machine))
    found = compare(tmp_path / "a", tmp_path / "b")
    assert found.differences[0].latency is None
    assert "timed on other machines" in found.differences[0].latency_reason


def test_the_command_prints_json_and_one_line_on_bad_input(tmp_path: Path) -> None:
    before = folder_of(tmp_path / "before", {"remnet": 0.1})
    after = folder_of(tmp_path / "after", {"remnet": 0.05})
    call = CliRunner().invoke
    content = json.loads(call(command, [str(before), str(after), "--json"]).stdout)
    assert content["differences"][0]["difference_m"]["value"] < 0
    assert "[" in call(command, [str(before), str(after)]).stdout
    with pytest.raises(BenchError, match="absent is not here"):
        call(command, ["absent", str(after)], catch_exceptions=False)
    (tmp_path / "x.json").write_text("{}")
    with pytest.raises(BenchError, match="no results"):
        call(command, [str(tmp_path / "x.json"), str(after)], catch_exceptions=False)


def test_the_picture_shows_every_model_once_and_a_bar_per_group(tmp_path: Path) -> None:
    results = read_results(folder_of(tmp_path, {"good": 0.02, "same": 0.0201, "bad": 0.2}))
    figure = tie_groups([ranked(board, results) for board in make_boards(results)])
    axes = figure.axes[0]
    names = [label.get_text().split()[0] for label in axes.get_yticklabels()]
    assert names == ["good/fp32", "same/fp32", "bad/fp32"]
    assert len(axes.lines) == 1 + 2  # the errors, and the groups {good, same} and {bad}
    assert "SIMULATED" in axes.get_title()
    with pytest.raises(ReportError, match="nothing to draw"):
        tie_groups([])


def test_every_model_of_a_folder_against_one_of_them(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "r", {"gbm": 0.05, "good": 0.02, "bad": 0.2})
    written = tmp_path / "tables.md"
    done = CliRunner().invoke(command, [str(folder), "--against", "gbm", "--out", str(written)])
    assert done.exit_code == 0, done.output
    lines = written.read_text().splitlines()
    rows = {line.split("|")[1].strip(): line.split("|") for line in lines if line.startswith("| ")}
    assert set(rows) >= {"good", "gbm", "bad"}
    assert rows["good"][3].strip().startswith("**-0.02")
    assert rows["bad"][3].strip().startswith("+0.1")
    assert any("At least as good as gbm" in line and line.endswith(": good.") for line in lines)
    assert any("Worse than gbm" in line and line.endswith(": bad.") for line in lines)
    with pytest.raises(BenchError, match="svm was run on no data set with backend fp32"):
        CliRunner().invoke(
            command,
            [str(folder), "--against", "svm"],
            catch_exceptions=False,
            standalone_mode=False,
        )
