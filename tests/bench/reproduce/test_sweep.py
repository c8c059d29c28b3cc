"""Sweeps: the same points however they are spread, kept as they finish, resumed after a kill."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from click.testing import CliRunner
from light_tasks import Nothing, Number, fail_on_three, square

from bench import parallel as spread
from bench.cli.reproduce import command
from bench.errors import BenchError
from bench.parallel import Spread
from bench.reproduce.context import Context
from bench.reproduce.experiments.cir_size import Data, Point, train_point
from bench.reproduce.experiments.generalisation import Bar, Classes, Part, train_bar
from bench.reproduce.sweep import sweep

ROWS = 96
BATCH_HANGS_S = 300


def made_up(seed: int) -> tuple[Any, Any]:
    rng = np.random.default_rng(seed)
    cirs = rng.rayleigh(100, (ROWS, 157)).astype(np.float32)
    return cirs, (cirs[:, 6] / 1000).astype(np.float32)


def networks() -> tuple[Data, list[Point]]:
    (train, errors), (test, test_errors) = made_up(0), made_up(1)
    links = np.repeat(np.arange(12), ROWS // 12).astype(str)
    data = Data(train, errors, test, test_errors, links)
    return data, [Point(samples, (0, 1), 1) for samples in (8, 16)]


def bars() -> tuple[Classes, list[Bar]]:
    parts = {name: Part(*made_up(seed)) for seed, name in enumerate(("big", "small"))}
    return Classes(parts, parts), [Bar(name, (0, 1, 2), 2) for name in parts]


def points(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("points/[!.]*")}  # no half ones


def swept(out: Path, how: Spread, work: Any, made: tuple[Any, list[Any]]) -> dict[str, bytes]:
    """Return the point files as written when spread like this."""
    results = sweep(Context("rooms", out, spread=how), "sweep", work, *made)
    assert all(result is not None for result in results)
    return points(out)


@pytest.mark.slow
@pytest.mark.parametrize(("work", "make"), [(train_point, networks), (train_bar, bars)])
def test_results_do_not_depend_on_how_they_were_spread(
    work: Any, make: Any, cluster: str, tmp_path: Path
) -> None:
    """For processes, the killed sweep below shows it."""
    alone = swept(tmp_path / "one", Spread(), work, make())
    assert len(alone) == 2
    assert swept(tmp_path / "dask", Spread(scheduler=cluster), work, make()) == alone


@pytest.mark.slow
def test_trained_together_or_alone_the_mae_of_every_seed_is_the_same() -> None:
    (data, _), (classes, _) = networks(), bars()
    point, bar = Point(16, tuple(range(10)), 2), Bar("big", tuple(range(20)), 2)
    together = [seed["value"] for seed in train_point(data, point)]
    alone = [train_point(data, replace(point, seeds=(seed,)))[0]["value"] for seed in point.seeds]
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-4)
    assert len(set(together)) == 10
    stacked = train_bar(classes, bar)["small"]
    singly = [train_bar(classes, replace(bar, seeds=(seed,)))["small"][0] for seed in bar.seeds]
    np.testing.assert_allclose(stacked, singly, rtol=0, atol=1e-4)


def test_results_keep_the_order_of_the_tasks(cluster: str, tmp_path: Path) -> None:
    tasks = [Number(value) for value in range(7)]
    for at, how in enumerate((Spread(), Spread(jobs=2), Spread(scheduler=cluster))):
        context = Context("rooms", tmp_path / str(at), spread=how)
        assert sweep(context, "squares", square, Nothing(), tasks) == [v * v for v in range(7)]


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_failure_comes_through_and_finished_points_stay(jobs: int, tmp_path: Path) -> None:
    context = Context("rooms", tmp_path, spread=Spread(jobs))
    tasks = [Number(value) for value in (1, 2, 3)]
    with pytest.raises(BenchError, match="three is not possible"):
        sweep(context, "numbers", fail_on_three, Nothing(), tasks)
    kept = points(tmp_path)
    assert [json.loads(content)["result"] for content in kept.values()] != []
    assert sweep(context, "numbers", fail_on_three, Nothing(), tasks[:2]) == [1, 2]
    assert kept.items() <= points(tmp_path).items()


def test_a_damaged_point_is_made_again(tmp_path: Path) -> None:
    context = Context("rooms", tmp_path)
    tasks = [Number(4), Number(5)]
    sweep(context, "squares", square, Nothing(), tasks)
    whole = points(tmp_path)
    next(tmp_path.rglob("points/*")).write_text('{"task": {"val')
    assert sweep(context, "squares", square, Nothing(), tasks) == [16, 25]
    assert points(tmp_path) == whole


def test_no_scheduler_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(spread, "_PATIENCE_S", 0.5)
    context = Context("rooms", tmp_path, spread=Spread(scheduler="tcp://127.0.0.1:1"))
    with pytest.raises(BenchError, match="no Dask scheduler answers there") as caught:
        sweep(context, "squares", square, Nothing(), [Number(1)])
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_killed_sweep_continues_with_the_same_numbers(deepuwb: Path, tmp_path: Path) -> None:
    out, whole = tmp_path / "out", tmp_path / "whole"
    with started(out, "--jobs", "2") as process:
        wait_for_a_point(out, process)
        workers = psutil.Process(process.pid).children(recursive=True)
        process.send_signal(signal.SIGKILL)
    assert len(workers) >= 2
    assert psutil.wait_procs(workers, timeout=BATCH_HANGS_S)[1] == [], "workers end with it"
    first = points(out)
    assert not list(out.rglob("cir-size.json")), "killed before it was done"
    assert all(json.loads(content)["result"] for content in first.values())
    for folder in (out, whole):
        asked = ["cir-size", "--data", "deepuwb", "--quick", "--out", str(folder), "--json"]
        assert CliRunner().invoke(command, asked, catch_exceptions=False).exit_code == 0
    assert first.items() <= points(out).items()
    assert points(out) == points(whole)
    tables = [json.loads(found(folder).read_text())["tables"] for folder in (out, whole)]
    assert tables[0] == tables[1]


def started(out: Path, *more: str) -> subprocess.Popen[bytes]:
    command = ("reproduce", "cir-size", "--data", "deepuwb", "--quick", "--out", str(out))
    code = "from bench.cli.main import main; main()"
    return subprocess.Popen(
        [sys.executable, "-c", code, *command, *more, "--json"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=dict(os.environ),
    )  # fmt: skip


def wait_for_a_point(out: Path, process: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + BATCH_HANGS_S
    while not points(out) and process.poll() is None and time.monotonic() < end:
        time.sleep(0.01)
    assert process.poll() is None, "it ended before it could be killed"


def found(out: Path) -> Path:
    (path,) = out.rglob("cir-size.json")
    return path
