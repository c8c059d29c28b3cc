"""A board longer than a screen shows each model once, by its cheapest backend that is as good."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import result_files as files

from bench.results import Size, to_json
from reports import make_boards, read_results
from reports.condensed import SCREEN_ROWS, condensed
from reports.leaderboard import leaderboard
from reports.markdown import to_markdown
from reports.overview import Ranked, overview, ranked

LINKS, ROWS = 20, 5
BACKENDS = {"fp32": (0.0, 30_000), "graph": (0.0, 31_000), "int8": (0.0, 15_000)}
BROKEN = {"coarse": (0.5, 1_000)}  # the smallest file, and far worse


def _predictions(folder: Path, name: str, left_m: float, seed: int) -> None:
    links = np.repeat(np.arange(LINKS), ROWS)
    left = left_m * (1 + 0.1 * np.random.default_rng(seed).standard_normal(LINKS)[links])
    table = pd.DataFrame({"row": np.arange(len(links)), "link": links.astype(str)})
    table["error_m"], table["predicted_m"] = 1.0, 1.0 - left
    table["scored_as_los"] = False
    (folder / "predictions").mkdir(exist_ok=True)
    table.to_parquet(folder / "predictions" / f"{name}.parquet")


def _board(path: Path, models: int, backends: dict[str, tuple[float, int]]) -> Ranked:
    (path / "runs").mkdir(parents=True)
    for number in range(models):
        for backend, (worse_m, size) in backends.items():
            mae = 0.05 + 0.05 * number + worse_m
            record = files.run(f"model{number}", backend, nlos=files.score(mae))
            record = replace(record, size=Size(size, size, size, size))
            digest = record.key.digest()
            (path / "runs" / f"{digest}.json").write_text(to_json(record))
            _predictions(path, digest, mae, seed=number)
    results = read_results(path)
    [board] = make_boards(results)
    return condensed(ranked(board, results), results)


def test_a_short_board_is_left_as_it_is(tmp_path: Path) -> None:
    short = _board(tmp_path, 3, BACKENDS)
    assert len(short.board.entries) == 9
    assert short.chosen_of is None


def test_of_each_model_the_smallest_that_is_as_good_as_its_best(tmp_path: Path) -> None:
    short = _board(tmp_path, 7, BACKENDS | BROKEN)
    assert short.chosen_of == 28 > SCREEN_ROWS
    assert {entry.name for entry in short.board.entries} == {f"model{k}/int8" for k in range(7)}
    assert [one.ranks for one in short.ranking.models] == [str(k) for k in range(1, 8)]
    assert "One row per model, of 28:" in to_markdown(overview([short]))


def test_the_details_show_rank_and_ties_of_every_row(tmp_path: Path) -> None:
    one = _board(tmp_path, 2, BACKENDS)
    text = to_markdown(leaderboard([one.board], rankings=[one.ranking]))
    header, _, *rows = [line for line in text.splitlines() if line.startswith("|")][:8]
    assert [cell.strip() for cell in header.split("|")][3:5] == ["Rank", "Ties"]
    assert len(rows) == 6
    assert all("1-3" in row for row in rows[:3])
