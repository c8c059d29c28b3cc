"""The column that says who makes lines of sight worse."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import result_files as files

from bench.results import to_json
from reports import make_boards, read_results
from reports.harm import HEADER, harmed, has_los
from reports.markdown import to_markdown
from reports.overview import overview, ranked


def folder_of(path: Path, maes: dict[str, float], floors: tuple[str, ...]) -> Path:
    (path / "runs").mkdir(parents=True)
    for model, mae in maes.items():
        los = replace(files.score(mae), raw_mae_m=0.05)
        record = replace(files.run(model, nlos=files.score(0.1)), los=los, floor=model in floors)
        (path / "runs" / f"{record.key.digest()}.json").write_text(to_json(record))
    return path


def test_worse_than_raw_or_a_floor_is_marked(tmp_path: Path) -> None:
    maes = {"none": 0.05, "constant": 0.04, "good": 0.03, "middling": 0.045, "bad": 0.07}
    maes["even"] = 0.04005  # less than 0.1 mm
    results = read_results(folder_of(tmp_path, maes, ("none", "constant")))
    [board] = make_boards(results)
    read = harmed(board)
    said = {entry.model: read(entry).cell.text for entry in board.entries}
    assert said == {
        "none": "no",
        "constant": "no",
        "good": "no",
        "even": "no",
        "middling": "worse than constant",
        "bad": "worse than raw, constant",
    }
    text = to_markdown(overview([ranked(board, results)]))
    assert HEADER in text
    assert "worse than raw, constant" in text


def test_boards_without_lines_of_sight_have_no_such_column(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    record = replace(files.run("good", nlos=files.score(0.1)), los=None)
    (tmp_path / "runs" / f"{record.key.digest()}.json").write_text(to_json(record))
    results = read_results(tmp_path)
    [board] = make_boards(results)
    assert not has_los(board)
    assert f"| {HEADER} |" not in to_markdown(overview([ranked(board, results)]))
