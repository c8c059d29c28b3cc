"""The worker's protocol, spoken to in this process."""

from __future__ import annotations

import gc
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest

from bench.measure import timing_worker
from bench.measure.timing_worker import Timer, cirs, pin, serve

OPEN = {
    "do": "open",
    "path": "model.onnx",
    "width": 12,
    "batches": [1, 4],
    "rows": 16,
    "preload": ["json", "no_such_runtime"],
}


@pytest.fixture
def runners(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make `local_runners` importable, and leave this process unpinned."""
    source = "def first(path, threads):\n    assert threads == 1\n    return lambda x: x[:, 0]\n"
    source += "def nan(path, threads):\n    return lambda x: x[:, 0] * float('nan')\n"
    (tmp_path / "local_runners.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(timing_worker, "pin", lambda: 1)


def _talk(*requests: dict[str, object]) -> list[dict[str, object]]:
    answers = io.StringIO()
    serve(io.StringIO("".join(json.dumps(request) + "\n" for request in requests)), answers)
    return [json.loads(line) for line in answers.getvalue().splitlines()]


def test_a_whole_conversation(runners) -> None:
    opened, calibrated, sampled_all, burst = _talk(
        {**OPEN, "opener": "local_runners:first"},
        {"do": "calibrate", "sample_s": 1e-4},
        {"do": "round", "samples": {"4": 7, "16": 1}},
        {"do": "burst", "batch": 1, "seconds": 0.01},
    )
    assert opened["core"] == 1
    assert opened["peak_memory_bytes"] >= 0
    assert set(calibrated["calls"]) == {"1", "4", "16"}
    sampled, last = sampled_all["4"], sampled_all["16"]
    assert (len(sampled["samples_us"]), len(last["samples_us"])) == (7, 1)
    assert sampled["reference_us"][1] == last["reference_us"][0]  # between them
    assert 0 < sampled["core_share"] < 1.5  # the two clocks tick apart by microseconds
    assert all(sample > 0 for sample in sampled["samples_us"])
    before, after = sampled["reference_us"]
    assert before > 0
    assert after > 0
    assert burst["calls"] >= 1
    assert burst["seconds"] >= 0.01
    assert gc.isenabled()


def test_errors_are_answers_and_the_conversation_goes_on(runners) -> None:
    answers = _talk(
        {"do": "round", "samples": {"1": 1}},
        {**OPEN, "opener": "local_runners:nan"},
        {**OPEN, "opener": "local_runners:first"},
    )
    assert "AssertionError" in answers[0]["error"]
    assert "not finite" in answers[1]["error"]
    assert "error" not in answers[2]


def test_calibrated_samples_last_as_long_as_asked(monkeypatch) -> None:
    now = iter(range(0, 10**12, 5_000))  # a clock that moves 5 us each time it is read
    monkeypatch.setattr(timing_worker.time, "perf_counter_ns", lambda: next(now))
    monkeypatch.setattr(timing_worker, "WARM_UP_S", 0)
    timer = Timer(lambda x: x[:, 0], 3, [1])
    assert timer.calibrate(sample_s=1e-3) == {1: 200}
    assert timer.reference.calls in (100, 101)  # a float may land just above


def test_the_reference_is_always_the_same_work() -> None:
    one, two = timing_worker.Reference(), timing_worker.Reference()
    one.time_us()
    two.time_us()
    np.testing.assert_array_equal(one.result, one.left @ one.right)
    np.testing.assert_array_equal(one.result, two.result)
    one.calls = 500
    assert 0.2 < np.median([one.time_us() for _ in range(9)]) < 5000  # 1.8 million operations


def test_inputs_look_like_cirs_and_are_the_same_every_time() -> None:
    made = cirs(50, 157)
    assert made.dtype == np.float32
    assert (made > 0).all()
    assert np.median(made[:, :10]) > 10 * np.median(made[:, -20:])
    np.testing.assert_array_equal(made, cirs(50, 157))


def test_pinning_takes_the_last_allowed_core_and_survives_a_system_that_refuses(
    monkeypatch,
) -> None:
    if hasattr(os, "sched_getaffinity"):
        before = os.sched_getaffinity(0)
        assert pin() == max(before)
        os.sched_setaffinity(0, before)
    monkeypatch.delattr(timing_worker.psutil.Process, "cpu_affinity", raising=False)
    assert pin() is None
