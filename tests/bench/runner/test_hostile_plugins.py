"""Plug-ins that quit, print or fail in a run, and two runs that write one folder at once."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import constant_graphs
import pytest
from click.testing import CliRunner
from runner_tables import tiny

import bench
from bench.cli.main import group
from bench.recordings import write_recordings
from bench.runner import api

THEIRS = """
import sys
from backends.fp32 import Fp32Backend
from zoo.none import NoMitigation

class Said(Exception):
    def __str__(self):
        raise ValueError

class QuitsInFit(NoMitigation):
    def fit(self, X, y, progress=None):
        sys.exit(0)

class Loud(NoMitigation):
    def fit(self, X, y, progress=None):
        print("LOUD")
        return super().fit(X, y)

class Mute(NoMitigation):
    def fit(self, X, y, progress=None):
        raise Said

class QuitsInBuild(Fp32Backend):
    def build(self, *args, **kwargs):
        sys.exit(0)

class OtherOpener(Fp32Backend):
    opener = "os:system"
    def build(self, *args, **kwargs):
        from dataclasses import replace
        return replace(super().build(*args, **kwargs), opener="os:popen")
"""
POINTS = """[bench.models]
quits-in-fit = theirs_run:QuitsInFit
loud = theirs_run:Loud
mute = theirs_run:Mute
[bench.backends]
quits-in-build = theirs_run:QuitsInBuild
other-opener = theirs_run:OtherOpener
"""


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.parquet"
    write_recordings(tiny(), path)
    return path


@pytest.fixture
def theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "theirs_run.py").write_text(THEIRS)
    info = tmp_path / "theirs_run-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs_run\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(POINTS)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(api, "time_artifacts", lambda *_, **__: ([], []))


@pytest.mark.usefixtures("theirs")
def test_a_plug_in_that_quits_or_cannot_speak_fails_alone(table: Path, tmp_path: Path) -> None:
    done = bench.run(
        "none,quits-in-fit,mute",
        "fp32,quits-in-build,other-opener",
        str(table),
        split="link-kfold:2",
        out=tmp_path / "out",
    )
    assert [(one.key.model, one.key.backend) for one in done.runs] == [("none", "fp32")]
    reasons = {(one.model, one.backend): one.reason for one in done.failures}
    quit_words = "it tried to end the program (exit code 0)"
    assert reasons[("quits-in-fit", "fp32")] == quit_words
    assert reasons[("none", "quits-in-build")] == quit_words
    assert "its message cannot be had" in reasons[("mute", "fp32")]
    assert "'os:popen'" in reasons[("none", "other-opener")]
    assert len(reasons) == 8


@pytest.mark.usefixtures("theirs")
def test_a_plug_in_that_prints_keeps_the_json_valid(table: Path, tmp_path: Path) -> None:
    ask = ["run", "--model", "loud", "--backend", "fp32", "--data", str(table), "--json"]
    ask += ["--split", "link-kfold:2", "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(group, ask)
    assert done.exception is None, done.exception
    assert len(json.loads(done.stdout)["runs"]) == 1
    assert "LOUD" in done.stderr


def _figures(out: Path) -> dict[str, object]:
    """Return what a folder's records say of accuracy and files, by name."""
    found = {}
    for path in (out / "runs").glob("*.json"):
        content = json.loads(path.read_text())
        kept = ("nlos", "los", "artifacts_sha256", "predictions_sha256", "weights_sha256", "key")
        found[path.name] = {name: content[name] for name in kept}
    return found


WORK = """
import sys
import backends.export
import bench
from bench.runner import api
sys.path.append(sys.argv[3])
import constant_graphs
backends.export.export_module = constant_graphs.export_module
api.time_artifacts = lambda *_, **__: ([], [])
done = bench.run("none,constant", "fp32,graph", sys.argv[1], split="link-kfold:2", seeds=2,
                 out=sys.argv[2])
assert not done.failures, done.failures
"""


def test_two_processes_in_one_folder_give_the_numbers_of_one(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(api, "time_artifacts", lambda *_, **__: ([], []))

    def start(out: str) -> subprocess.Popen[bytes]:
        words = [str(table), str(tmp_path / out), str(Path(constant_graphs.__file__).parent)]
        return subprocess.Popen([sys.executable, "-c", WORK, *words])

    both = [start("shared"), start("shared")]
    assert [one.wait(timeout=600) for one in both] == [0, 0]
    monkeypatch.setattr("backends.export.export_module", constant_graphs.export_module)
    asked = ("none,constant", "fp32,graph", str(table))
    bench.run(*asked, split="link-kfold:2", seeds=2, out=tmp_path / "alone")
    alone = _figures(tmp_path / "alone")
    assert len(alone) == 8
    assert _figures(tmp_path / "shared") == alone
    assert not list((tmp_path / "shared").rglob("*.part*"))
    heard: list[str] = []
    watch = bench.runner.observer.Observer()
    watch.note = heard.append  # type: ignore[method-assign]
    again = bench.run(
        *asked, split="link-kfold:2", seeds=2, out=tmp_path / "shared", observer=watch
    )
    assert len(again.runs) == 8
    assert heard == []
