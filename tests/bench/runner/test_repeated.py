"""A run that is all there is found without reading the recordings or importing torch."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from runner_tables import tiny

import bench
from bench.plugins import plugins
from bench.recordings import write_recordings
from bench.results import RunRecord
from bench.runner import api
from zoo.base import MitigationModel

SCRIPT = """
import sys, bench
table, out = sys.argv[1:]
done = bench.run("constant", "fp32", table, split="link-kfold:2", out=out, timed=False)
print(done.runs[0].nlos.mae_m.value, "torch" in sys.modules, "sklearn" in sys.modules)
"""


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.parquet"
    write_recordings(tiny(), path)
    settle(path)
    return path


def settle(path: Path) -> None:
    then = time.time_ns() - 10**10
    os.utime(path, ns=(then, then))


def run(table: Path, out: Path) -> RunRecord:
    [one] = bench.run("none", "fp32", str(table), split="link-kfold:2", out=out, timed=False).runs
    return one


def test_a_second_run_reads_nothing(table: Path, tmp_path: Path, monkeypatch) -> None:
    first = run(table, tmp_path / "out")
    with monkeypatch.context() as patch:
        patch.setattr(api, "load_material", lambda *_: pytest.fail("the recordings were read"))
        assert run(table, tmp_path / "out") == first


def test_a_file_that_changed_is_read_again(table: Path, tmp_path: Path) -> None:
    first = run(table, tmp_path / "out")
    longer = tiny()
    write_recordings(longer.select(longer.frame.index.to_numpy()[:-4]), table)
    settle(table)
    assert run(table, tmp_path / "out").key.data_fingerprint != first.key.data_fingerprint


def test_a_file_that_changed_a_moment_ago_is_not_believed(table: Path, tmp_path: Path) -> None:
    """Written twice within one step of the clock it could look the same."""
    os.utime(table)
    run(table, tmp_path / "out")
    assert not list((Path(os.environ["BENCH_CACHE"]) / "answers").glob("recordings-*"))


def test_a_repeated_run_needs_neither_torch_nor_sklearn(table: Path, tmp_path: Path) -> None:
    asked = [sys.executable, "-c", SCRIPT, str(table), str(tmp_path / "out")]
    said = [subprocess.run(asked, capture_output=True, text=True, check=True) for _ in range(2)]
    first, again = (one.stdout.split() for one in said)
    assert again == [first[0], "False", "False"]


def test_what_ours_say_of_themselves_depends_on_their_source_alone() -> None:
    """It is kept by the hash of the source: a `cache_key` of ours would be missed."""
    models = [one.load() for one in plugins("models") if one.built_in]
    assert all(one.cache_key is MitigationModel.cache_key for one in models)
    backends = [one.load() for one in plugins("backends") if one.built_in]
    assert len({one.cache_key for one in backends}) == 1
