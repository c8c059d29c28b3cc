"""The page of results as text: complete, small, and inert whatever the records say."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import result_files as files
from click.testing import CliRunner

from bench.cli.site import command
from bench.results import to_json
from reports import make_boards, read_results
from reports.overview import ranked
from reports.site import Page, payload, render
from reports.site.payload import LONGEST_TEXT

NASTY = "</script><img src=x onerror=alert(1)>\x1b[31m"


def folder_of(path: Path, models: list[str], **changes: Any) -> Path:
    """A result folder with a run and predictions for every model, 30 links of 10 rows."""
    rng = np.random.default_rng(3)
    links = np.repeat(np.arange(30), 10)
    (path / "runs").mkdir(parents=True, exist_ok=True)
    (path / "predictions").mkdir(exist_ok=True)
    for number, model in enumerate(models):
        record = files.run(model, **changes)
        name = record.key.digest()
        (path / "runs" / f"{name}.json").write_text(to_json(record))
        error = rng.gamma(2, 0.1, 300)
        table = pd.DataFrame({"row": np.arange(300), "link": links.astype(str), "error_m": error})
        table["predicted_m"] = error * (1 - 0.1 * (number + 1))
        table["true_range_m"] = rng.uniform(1, 9, 300)
        table.assign(scored_as_los=False).to_parquet(path / "predictions" / f"{name}.parquet")
    return path


def data_of(folder: Path) -> dict[str, Any]:
    results = read_results(folder)
    return payload(results, [ranked(board, results) for board in make_boards(results)])


def test_the_data_of_a_board_is_all_there(tmp_path: Path) -> None:
    data = data_of(folder_of(tmp_path, ["remnet", "svm"]))
    board = data["boards"][0]
    assert board["simulated"] is True
    assert board["links"] == 30
    entry = {one["model"]: one for one in board["entries"]}["remnet"]
    assert entry["nlos"]["mae_m"]["value"] == 0.07
    assert entry["best_rank"] == 1
    left = entry["residuals"]
    assert sum(left["histogram"]["before"]) > 280
    assert len(left["links"]) == 30
    assert np.nanmax(left["distance"]["after_m"]) < np.nanmax(left["distance"]["before_m"])


def test_nothing_a_record_says_becomes_markup(tmp_path: Path) -> None:
    data = data_of(folder_of(tmp_path, [NASTY, "svm"], note=NASTY, data=NASTY))
    text = render(data, [Page(NASTY, f"# {NASTY}\n[x](javascript:alert(1))\n{NASTY}")], NASTY)
    assert "<img" not in text
    assert "\x1b" not in text
    assert "javascript:alert" not in text.replace("[x](javascript:alert(1))", "")
    held = re.search(r'id="data">(.*?)</script>', text, re.S)
    assert held is not None
    assert json.loads(held.group(1)) == data


def test_only_the_scripts_whose_hashes_stand_in_the_policy_run(tmp_path: Path) -> None:
    text = render(data_of(folder_of(tmp_path, ["remnet", "svm"])))
    assert len(re.findall(r"&#39;sha256-[A-Za-z0-9+/=]{44}&#39;", text)) == 2
    assert text.count("<script>") == 2
    assert not re.search(r"(src|href)=[\"']?https?:", text)


def test_names_of_megabytes_are_cut(tmp_path: Path) -> None:
    data = data_of(folder_of(tmp_path, ["m" * 5_000_000, "svm"]))
    assert max(len(one["model"]) for one in data["boards"][0]["entries"]) <= LONGEST_TEXT + 4


def test_five_hundred_records_make_less_than_three_megabytes(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for number in range(500):
        record = files.run(f"m{number % 50}", f"b{number // 50}")
        (tmp_path / "runs" / f"{record.key.digest()}.json").write_text(to_json(record))
    data = data_of(tmp_path)
    assert len(data["boards"][0]["entries"]) == 500
    assert len(render(data).encode()) < 3_000_000


def test_the_command_writes_one_file(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "r", ["remnet", "svm"])
    (tmp_path / "challenge.md").write_text("# Challenge\n\n| a | b |\n| - | - |\n| 1 | 2 |\n")
    arguments = ["--results", str(folder), "-o", str(tmp_path / "site")]
    arguments += ["--report", str(tmp_path / "challenge.md")]
    result = CliRunner().invoke(command, arguments, catch_exceptions=False)
    assert result.output.startswith(f"wrote {tmp_path / 'site' / 'index.html'}")
    text = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert "<td>2</td>" in text
    assert [path.name for path in (tmp_path / "site").iterdir()] == ["index.html"]
