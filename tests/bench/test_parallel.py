"""One rule for threads: BENCH_THREADS, whoever asks."""

from __future__ import annotations

import operator
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch

import bench
from bench.errors import BenchError
from bench.forked import able
from bench.parallel import a_few_at_once, in_processes, obey, threads
from zoo.none import NoMitigation

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def torch_as_before() -> Iterator[None]:
    before = torch.get_num_threads()
    yield
    torch.set_num_threads(before)


@pytest.mark.parametrize("count", [1, 3])
def test_torch_obeys(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BENCH_THREADS", str(count))
    obey()
    assert torch.get_num_threads() == threads() == count


def test_without_the_variable_torch_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("BENCH_THREADS", raising=False)
    torch.set_num_threads(3)
    obey()
    assert torch.get_num_threads() == 3


def test_models_are_trained_with_the_threads_asked_for(monkeypatch, tmp_path: Path) -> None:
    """Training went by torch's own number, whatever BENCH_THREADS said."""
    seen = []
    fit = NoMitigation.fit

    def watched(self, *rows, **more):
        seen.append(torch.get_num_threads())
        return fit(self, *rows, **more)

    monkeypatch.setattr(NoMitigation, "fit", watched)
    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_, **__: ([], []))
    monkeypatch.setenv("BENCH_THREADS", "3")
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "cache"))
    cirs = np.random.default_rng(0).rayleigh(50, (24, 157)).astype(np.float32)
    frame = pd.DataFrame({"range_m": 3.1, "true_range_m": 3.0, "cir": list(cirs)})
    frame = frame.assign(
        first_path_index=5.0, los=False, link=[f"l{row // 4}" for row in range(24)]
    )
    done = bench.run("none", "fp32", frame, split="link-kfold:2", out=tmp_path / "out")
    assert not done.failures
    assert seen
    assert set(seen) == {3}


@pytest.mark.parametrize("count", ["1", "2"])
def test_work_of_a_few_at_once_comes_in_order_and_its_problems_come_through(
    count: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BENCH_THREADS", count)
    assert list(a_few_at_once(lambda one: one**2, range(7))) == [0, 1, 4, 9, 16, 25, 36]
    with pytest.raises(ZeroDivisionError):
        list(a_few_at_once(lambda one: 1 / (3 - one), range(7)))


def test_work_in_processes_comes_in_order() -> None:
    assert list(in_processes(operator.add, 10, range(9), 2)) == list(range(10, 19))


def test_a_process_that_dies_is_said_in_a_line() -> None:
    with pytest.raises(BenchError, match="BENCH_THREADS=1 does with this one"):
        list(in_processes(operator.call, os._exit, [1], 2))


SCRIPT = """
import signal, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
from bench.parallel import in_processes
print("run", flush=True)
made = in_processes({work}, {shared}, [{item}] * 3, 2, {forks})
next(made)
print("works", flush=True)
list(made)
"""


def script(tmp_path: Path, **words: str) -> subprocess.Popen[str]:
    """Return a user's script that runs by itself, without a guard for what it does."""
    path = tmp_path / "script.py"
    path.write_text(SCRIPT.format(**words))
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [sys.executable, path], stdout=pipe, stderr=pipe, text=True, start_new_session=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip


either = pytest.mark.parametrize(
    "forks",
    ["False", pytest.param("True", marks=pytest.mark.skipif(not able(), reason="no forks here"))],
)


@either
def test_a_script_needs_no_guard(tmp_path: Path, forks: str) -> None:
    """Processes that start run a script again; this one would have started more, and failed."""
    add = "__import__('operator').add"
    done = script(tmp_path, work=add, shared="1", item="2", forks=forks)
    assert (*done.communicate(timeout=60), done.returncode) == ("run\nworks\n", "", 0)


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="no groups of processes here")
@either
def test_processes_end_without_a_word_when_interrupted(tmp_path: Path, forks: str) -> None:
    """Each printed a traceback of its own."""
    call = "__import__('operator').call"
    done = script(tmp_path, work=call, shared="time.sleep", item="1.5", forks=forks)
    assert done.stdout is not None
    while done.stdout.readline() != "works\n":
        pass
    os.killpg(done.pid, signal.SIGINT)
    said = done.communicate(timeout=60)[1]
    assert said.count("Traceback") == 1  # the script's own
    assert "SpawnProcess" not in said


def test_nothing_else_counts_cores() -> None:
    """Who needs threads asks bench.parallel; the machine itself may be described."""
    describes = {"parallel.py", "machine.py", "quiet.py", "cpu.py", "timing_worker.py"}
    words = re.compile(r"sched_getaffinity|os\.cpu_count|ThreadPoolExecutor\((?!1\))")
    found = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "bench").rglob("*.py")
        if path.name not in describes and words.search(path.read_text(encoding="utf-8"))
    ]
    assert found == []
