"""One rule for threads: BENCH_THREADS, whoever asks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch

import bench
from bench.parallel import a_few_at_once, obey, threads
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
