"""Where a board's time goes, on a small table: shares of one run, and two processes against one.

Two processes start, and import torch, once each: on so small a table they are no quicker.

python -m pytest -s tests/benchmarks/test_board_stages.py
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import psutil
import pytest

import bench
from bench.recordings.table import Recordings

MODELS, BACKENDS = "remnet,small-cnn", "fp32,qat,c-fp32"
ROWS, LINKS = 300, 20
STAGES = {
    "fit": "bench.runner.groups.fit_fold",
    "export": "backends.export._export",
    "train with rounding": "backends.qat.train_quantised",
    "compile C": "backends.c.compile.compile_files",
    "score": "bench.runner.records.score_rows",
    "time": "bench.runner.api.time_artifacts",
}
"""None of these is called inside another."""


def table() -> Recordings:
    rng = np.random.default_rng(0)
    error_m = rng.uniform(0.0, 0.5, ROWS)
    cirs = rng.rayleigh(50.0, (ROWS, 157)).astype(np.float32)
    cirs[:, 7] += 4000.0 * error_m
    frame = pd.DataFrame({"range_m": 3.0 + error_m, "true_range_m": 3.0, "cir": list(cirs)})
    number = np.arange(ROWS) % LINKS
    names = {"link": [f"l{one}" for one in number], "environment": np.where(number % 4, "a", "b")}
    return Recordings(frame.assign(first_path_index=5.0, los=False, **names), "tiny")


class Clock:
    """Wall and processor seconds by stage, children that have ended included."""

    def __init__(self) -> None:
        self.wall_s: dict[str, float] = {}
        self.cpu_s: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        start, busy = time.perf_counter(), used_s()
        yield
        self.wall_s[name] = self.wall_s.get(name, 0.0) + time.perf_counter() - start
        self.cpu_s[name] = self.cpu_s.get(name, 0.0) + used_s() - busy

    def watching(self, name: str, work: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*given: Any, **named: Any) -> Any:
            with self.stage(name):
                return work(*given, **named)

        return watched


def used_s() -> float:
    found = psutil.Process().cpu_times()
    return float(found.user + found.system + found.children_user + found.children_system)


def board(folder: Path, monkeypatch: pytest.MonkeyPatch, **how: Any) -> list[Any]:
    monkeypatch.setenv("BENCH_CACHE", str(folder / "cache"))
    asked = {
        "model": MODELS,
        "backend": BACKENDS,
        "split": "leave-environment-out:b",
        "wait": False,
    }
    done = bench.run(**asked, data=table(), out=folder / "out", **how)
    assert done.failures == []
    assert len(list((folder / "cache" / "fits").glob("*.npz"))) == 2  # the teacher's serves both
    return [(one.key.model, one.key.backend, one.nlos) for one in done.runs]


def test_where_the_time_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    with monkeypatch.context() as patch:
        for name, place in STAGES.items():
            module, _, function = place.rpartition(".")
            work = getattr(__import__(module, fromlist=[function]), function)
            patch.setattr(place, clock.watching(name, work))
        with clock.stage("all"):
            alone = board(tmp_path / "one", patch, jobs=1)
    for name, wall_s in clock.wall_s.items():
        whole, cpu = wall_s / clock.wall_s["all"], clock.cpu_s[name] / clock.cpu_s["all"]
        print(f"{name:20} {whole:6.1%} of the wall time, {cpu:6.1%} of the processor's")
    with clock.stage("two"):
        together = board(tmp_path / "two", monkeypatch, jobs=2, timed=False)
    left = clock.wall_s["all"] - clock.wall_s["time"]
    print(f"two processes: {clock.wall_s['two'] / left:.2f} of one's wall time, timing apart")
    assert together == alone
