"""`bench history`: real regressions are named, lingering noise is not."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import result_files as files
from click.testing import CliRunner
from test_overview_compare import folder_of

from bench.cli.history import command
from bench.errors import BenchError
from reports import ReportError
from reports.ranking.compare import compare
from reports.ranking.history import Drift, expected_us, history


def versions(path: Path, *spreads: float) -> list[Path]:
    """A folder per version of the code, each a month later."""
    return [
        folder_of(
            path / f"v{number}",
            {"remnet": spread},
            code_hash=f"c0de{number}",
            created_utc=f"2026-{number + 1:02d}-01T10:00:00+00:00",
        )
        for number, spread in enumerate(spreads)
    ]


def test_a_version_that_errs_more_is_a_regression_and_one_that_does_not_is_none(
    tmp_path: Path,
) -> None:
    found = history(versions(tmp_path, 0.1, 0.1, 0.15))
    assert [one.verdict for one in found.changes] == ["no change", "REGRESSION"]
    assert found.changes[1].difference.difference_m.value == pytest.approx(0.05, abs=0.005)
    assert len(found.versions) == 3


def test_the_order_is_that_of_time_not_of_the_arguments(tmp_path: Path) -> None:
    found = history(versions(tmp_path, 0.2, 0.1)[::-1])
    assert [one.verdict for one in found.changes] == ["improvement"]


def test_lingering_noise_is_no_regression_more_often_than_it_says() -> None:
    rng = np.random.default_rng(3)
    false = 0
    for _ in range(400):
        noise, logs = 0.0, []
        for _ in range(26):
            noise = 0.7 * noise + rng.normal(0, 0.03)
            logs.append(noise)
        values = list(90 * np.exp(logs))
        low, high = expected_us(values[:-1])
        false += not low <= values[-1] <= high
    assert false / 400 <= 0.09


def test_a_latency_twice_as_long_is_seen_and_few_are_not_judged() -> None:
    steady = [90.0, 91.0, 90.5, 89.8, 90.2, 90.6]
    assert Drift("a", "m", (*steady, 180.0), expected_us(steady)).verdict == "REGRESSION"
    assert Drift("a", "m", (*steady, 90.3), expected_us(steady)).verdict == "no change"
    assert "too few" in Drift("a", "m", (90.0, 180.0), expected_us([90.0])).verdict


def test_the_command_and_its_bad_input(tmp_path: Path) -> None:
    folders = list(map(str, versions(tmp_path, 0.1, 0.2)))
    run = files.timing(files.run("remnet"))
    for number in range(2):
        later = replace(run, created_utc=f"2026-0{number + 1}-02T00:00:00+00:00")
        files.write(tmp_path / f"v{number}", later)
    call = CliRunner().invoke
    content = json.loads(call(command, [*folders, "--json"], catch_exceptions=False).stdout)
    assert content["changes"][0]["verdict"] == "REGRESSION"
    assert len(content["latencies"][0]["medians_us"]) == 2
    assert "REGRESSION" in call(command, folders).stdout
    with pytest.raises(BenchError, match="one version only"):
        call(command, folders[:1], catch_exceptions=False)
    with pytest.raises(BenchError, match="no results folder"):
        call(command, ["absent"], catch_exceptions=False)


def test_a_copy_of_a_folder_is_no_second_version(tmp_path: Path) -> None:
    [folder] = versions(tmp_path, 0.1)
    copy = Path(shutil.copytree(folder, tmp_path / "copy"))
    with pytest.raises(ReportError, match="one version only"):
        history([folder, copy])


def test_records_that_are_not_believed_are_named(tmp_path: Path) -> None:
    before, after = versions(tmp_path, 0.1, 0.2)
    record = next((after / "runs").glob("*.json"))
    (after / "runs" / "edited.json").write_text(record.read_text().replace("0.07", "0.01"))
    (after / "runs" / "renamed.json").write_text(record.read_text())
    for found in (history([before, after]), compare(before, after)):
        assert len(found.left_out) == 2
        assert "edited or damaged" in found.left_out[0]
        assert "it was renamed" in found.left_out[1]
    shown = CliRunner().invoke(command, [str(before), str(after)]).stdout
    assert "Files left out: 2" in shown
    with pytest.raises(ReportError, match="edited or damaged"):
        compare(before, after / "runs" / "edited.json")
