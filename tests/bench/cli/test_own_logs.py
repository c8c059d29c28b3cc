"""Tried as a new user would: own logs to a leaderboard in three commands."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from bench.cli import main as cli
from bench.recordings import read_recordings

LINKS, ROWS = 6, 8


@pytest.fixture(autouse=True)
def _untimed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Timing takes a minute on a busy machine and is tested on its own."""
    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_, **__: ([], []))


def _bench(*arguments: object) -> str:
    done = CliRunner().invoke(cli.group, [str(a) for a in arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


def _rows(link: int) -> pd.DataFrame:
    """Return ranges of one link as a logger may write them: millimetres, German names."""
    rng = np.random.default_rng(link)
    error_mm = rng.gamma(2.0, 60.0, ROWS)
    cirs = rng.integers(0, 60, (ROWS, 157))
    cirs[:, 6] += (12000 * np.exp(-error_mm / 250)).astype(int)
    return pd.DataFrame(
        {
            "Abstand gemessen": 5000.0 + error_mm,
            "Abstand wahr [cm]": 500.0,
            "Sichtverbindung": "ja" if link % 2 else "nein",
            "Knoten": f"K{link}",
            "Impulsantwort": [" ".join(map(str, cir)) for cir in cirs],
            "FP_INDEX": 6 * 64 if link % 2 else 5 * 64 + 16,
            "CIR_PWR": 9000,
            "FP_AMPL1": 5000,
            "FP_AMPL2": 6000,
            "FP_AMPL3": 5500,
            "RXPACC": 1010,
        }
    )


MAPS = (
    "range=Abstand gemessen:mm,true_range=Abstand wahr [cm]:cm",
    "los=Sichtverbindung,cir=Impulsantwort,first_path_index=FP_INDEX:10.6",
)


def _board(tmp_path: Path, own: Path) -> str:
    out = tmp_path / "results"
    _bench("run", "--data", own, "--model", "none", "--backend", "fp32", "--split", "link-kfold:3",
           "--device", "host", "--out", out)  # fmt: skip
    board = _bench("leaderboard", "--results", out)
    assert len(list(out.glob("runs/*.json"))) == 1
    return board


def test_a_german_csv_becomes_a_leaderboard_in_three_commands(tmp_path: Path) -> None:
    csv, own = tmp_path / "messung.csv", tmp_path / "own.parquet"
    table = pd.concat([_rows(link) for link in range(LINKS)])
    csv.write_text(table.to_csv(index=False, sep=";", decimal=","), encoding="cp1252")
    maps = [part for text in MAPS for part in ("--map", text)]
    told = _bench("data", "import", csv, "-o", own, *maps, "--link", "Knoten")
    assert f"{LINKS} links, mean |range error| 0.1" in told
    frame = read_recordings(own).frame
    assert len(frame) == LINKS * ROWS
    assert frame["true_range_m"].unique() == [5.0]
    assert {"rx_power_dbm", "first_path_power_dbm", "preamble_count"} <= set(frame)
    board = _board(tmp_path, own)
    assert "own.parquet" in board
    assert "SIMULATED" not in board.splitlines()[0]


def test_a_folder_of_raw_logs_becomes_a_leaderboard_in_three_commands(tmp_path: Path) -> None:
    folder, own = tmp_path / "logs", tmp_path / "own.parquet"
    for link in range(LINKS):
        path = folder / ("los" if link % 2 else "nlos") / f"node{link}_5m.log"
        path.parent.mkdir(parents=True, exist_ok=True)
        raw = _rows(link).drop(columns=["Abstand wahr [cm]", "Sichtverbindung", "Knoten"])
        path.write_text("# logger 1.0\n" + raw.to_csv(index=False, sep="\t"))
    told = _bench("data", "import", folder, "-o", own, "--from-name", r"(?P<d>\d+)m\.log",
                  "--map", "range=Abstand gemessen:mm,true_range=d:m,los=folder",
                  "--map", "cir=Impulsantwort,first_path_index=FP_INDEX:10.6",
                  "--link", "file", "--json")  # fmt: skip
    found = json.loads(told)
    assert (found["rows"], found["links"], found["warnings"]) == (LINKS * ROWS, LINKS, [])
    assert found["mae_m"] == pytest.approx(0.12, abs=0.03)
    assert "own.parquet" in _board(tmp_path, own)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--map", "range=Abstand gemessen:mmm"), "unknown unit 'mmm'"),
        (("--map", "range=Abstand:mm"), "no column 'Abstand'"),
        (("--map", "range=FP_INDEX,range=RXPACC"), "both mapped to range_m"),
        (("--csv", "x"), "--csv 'x': expected"),
        (("--link", "Ort"), "--link Ort: no column 'Ort'"),
        ((), "say which column it is and its unit"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    tmp_path: Path, arguments, expected, monkeypatch, capsys
) -> None:
    csv = tmp_path / "messung.csv"
    csv.write_text(_rows(0).to_csv(index=False, sep=";", decimal=","))
    words = ["bench", "data", "import", str(csv), "-o", str(tmp_path / "o.parquet"), *arguments]
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line
    assert not (tmp_path / "o.parquet").exists()


def test_what_looks_wrong_is_a_warning_with_its_cause(tmp_path: Path) -> None:
    csv, own = tmp_path / "log.csv", tmp_path / "own.parquet"
    csv.write_text("range_m,true_range_m\n500.1,0.5\n500.2,0.5\n")
    told = _bench("data", "import", csv, "-o", own)
    assert "warning: range_m is typically 1e+03 times true_range_m; probably millimetres" in told
    assert "warning: no link: name the columns" in told


def test_log_options_are_for_logs(tmp_path: Path, monkeypatch, capsys) -> None:
    words = ["bench", "data", "import", "rooms", "-o", str(tmp_path / "o.parquet"), "--link", "tx"]
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit):
        cli.main()
    assert "rooms: --map, --csv, --link" in capsys.readouterr().err
