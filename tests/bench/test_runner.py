"""The runner end to end on a tiny table, and what happens when things go wrong."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bench
from bench.errors import BenchError
from bench.measure.latency import measure
from bench.recordings import write_recordings
from bench.recordings.table import Recordings
from bench.runner import api
from bench.runner.folder import ResultFolder

TIMED = api.time_artifacts


@pytest.fixture(autouse=True)
def _untimed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Timing takes seconds for every pair; one test here has it, others stand in tests/measure."""
    monkeypatch.setattr(api, "time_artifacts", lambda *_: ([], []))


def tiny(rows_per_link: int = 12, links: int = 12, seed: int = 0) -> Recordings:
    """Noise CIRs whose first-path amplitude falls with the error, so that a model can learn."""
    rng = np.random.default_rng(seed)
    n = rows_per_link * links
    error_m = rng.gamma(2.0, 0.06, n)
    cirs = np.abs(rng.normal(0, 60, (n, 157)))
    pulse = np.exp(-(((np.arange(157) - 6) / 1.6) ** 2))
    cirs += 12000 * np.exp(-4 * error_m)[:, None] * pulse
    true_m = rng.uniform(1, 8, n)
    frame = pd.DataFrame(
        {
            "range_m": true_m + error_m,
            "true_range_m": true_m,
            "error_m": error_m,
            "cir": list(cirs.astype(np.float32)),
            "first_path_index": np.full(n, 5.2),
            "los": np.repeat(np.arange(links) % 3 == 0, rows_per_link),
            "environment": np.repeat(np.where(np.arange(links) % 2, "a", "b"), rows_per_link),
            "link": np.repeat([f"l{i}" for i in range(links)], rows_per_link),
        }
    )
    return Recordings(frame, source="tiny", simulator="noise, for tests", seed=seed)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.parquet"
    write_recordings(tiny(), path)
    return path


def test_run_scores_every_pair_and_reuses_it(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    ask = {"model": "none,mlp", "backend": "fp32,int8", "split": "link-kfold:2", "out": out}
    with monkeypatch.context() as timed:
        timed.setattr(api, "time_artifacts", TIMED)
        timed.setattr("bench.runner.timing.measure", partial(measure, rounds=6))
        first = bench.run(data=str(table), **ask)
    assert not first.failures
    assert len(first.timings) == 3
    states = {(r.key.model, r.key.backend): r.status for r in first.runs}
    assert states == {
        ("none", "fp32"): "ok",
        ("none", "int8"): "skipped",
        ("mlp", "fp32"): "ok",
        ("mlp", "int8"): "ok",
    }
    frame = first.frame().set_index(["model", "backend"])
    floor = frame.loc[("none", "fp32")]
    assert floor["nlos_mae_m"] == pytest.approx(floor["nlos_raw_mae_m"])
    assert floor["nlos_rows"] + floor["los_rows"] == len(tiny())
    for timing in first.timings:  # on a busy machine there is no figure, and a reason
        assert timing.withheld if not timing.latency else timing.latency[0].median_us > 0
    kept = [*out.glob("runs/*.json")]
    stamps = {p: p.stat().st_mtime_ns for p in kept}
    again = bench.run(data=str(table), **ask)
    assert {p: p.stat().st_mtime_ns for p in out.glob("runs/*.json")} == stamps
    assert [r.key for r in again.runs] == [r.key for r in first.runs]
    assert not list(out.rglob("*.part*"))


def test_same_seed_same_numbers_elsewhere(table: Path, tmp_path: Path) -> None:
    figures = []
    for place in ("one", "two"):
        os.environ["BENCH_CACHE"] = str(tmp_path / f"cache-{place}")
        done = bench.run("mlp", "fp32", str(table), split="link-kfold:2", out=tmp_path / place)
        figures.append((done.runs[0].nlos, done.runs[0].weights_sha256))
    assert figures[0] == figures[1]


def test_a_damaged_artifact_is_made_again(table: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = bench.run("none", "fp32", str(table), split="link-kfold:2", out=out)
    artifact = out / str(done.runs[0].artifact)
    artifact.write_bytes(b"truncated")
    assert ResultFolder(out).find_run(done.runs[0].key) is None
    bench.run("none", "fp32", str(table), split="link-kfold:2", out=out)
    assert ResultFolder(out).find_run(done.runs[0].key) is not None


def test_another_data_set_is_another_run(tmp_path: Path) -> None:
    keys = set()
    for seed in (0, 1):
        path = tmp_path / "same-name.parquet"
        write_recordings(tiny(seed=seed), path)
        done = bench.run("none", "fp32", str(path), split="link-kfold:2", out=tmp_path / "out")
        keys.add(done.runs[0].key.digest())
    assert len(keys) == 2


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"model": "remnett"}, "did you mean 'remnet'"),
        ({"backend": "int9"}, "did you mean 'int8'"),
        ({"device": "cortex-a55"}, "did you mean 'cortex-a5"),
        ({"data": "room"}, "did you mean 'rooms'"),
        ({"data": "absent.parquet"}, "absent.parquet"),
        ({"seeds": 0}, "from 1 to 10000"),
        ({"split": "link-kfold:99"}, "12"),
        ({"split": "by-row"}, "by-row"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    change: dict[str, object], expected: str, table: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    ask = {"model": "none", "backend": "fp32", "data": str(table), "out": out} | change
    with pytest.raises(BenchError, match=expected) as caught:
        bench.run(**ask)
    assert "\n" not in str(caught.value)
    assert not out.exists()


def test_cli_prints_one_line_and_exits_2(tmp_path: Path) -> None:
    ask = ["run", "--model", "nobody", "--backend", "fp32", "--out", str(tmp_path / "out")]
    done = _bench(*ask)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "unknown model 'nobody'" in done.stderr
    assert "Traceback" not in done.stderr


def test_read_only_out_is_refused(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write anywhere
    with pytest.raises(BenchError, match="read-only"):
        bench.run("none", "fp32", str(table), out=tmp_path / "out")


def test_full_disk_is_one_line_and_leaves_no_half_file(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(BenchError, match="No space left"):
        bench.run("none", "fp32", str(table), split="link-kfold:2", out=tmp_path / "out")
    assert [p for p in (tmp_path / "out").rglob("*") if p.is_file()] == []


@pytest.mark.slow
def test_killed_run_keeps_what_was_finished(table: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ask = ["run", "--model", "none", "--backend", "fp32,graph", "--seeds", "4"]
    ask += ["--data", str(table), "--split", "link-kfold:2", "--out", str(out)]
    victim = subprocess.Popen(
        [sys.executable, "-m", "bench", *ask], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    deadline = time.monotonic() + 120
    while not _finished(out) and time.monotonic() < deadline and victim.poll() is None:
        time.sleep(0.05)
    victim.send_signal(signal.SIGKILL)
    victim.wait()
    kept = {p: p.stat().st_mtime_ns for p in _finished(out)}
    assert kept
    for path in kept:
        json.loads(path.read_text())
    done = bench.run("none", "fp32,graph", str(table), seeds=4, split="link-kfold:2", out=out)
    assert {p: p.stat().st_mtime_ns for p in kept} == kept
    assert len(done.runs) == 2 * 4


def _finished(out: Path) -> list[Path]:
    """Return the runs that are finished: what begins with a dot is still being written."""
    return list(out.glob("runs/[!.]*.json"))


def _bench(*ask: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "bench", *ask], capture_output=True, text=True, check=False
    )
