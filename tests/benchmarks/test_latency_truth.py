"""The latency reported for a session against a bare loop over the same session.

The bare loop is a fresh process too: `for _ in range(30): run(x)` between two clock reads, with
nothing of the harness in it. It loops in the pauses between the harness's rounds, so that both see
the same machine whatever else it is doing. Two processes running the same loop differ by a per
cent or two, so three of each are compared.

Quiet: the harness waits, and a measurement counts only where it kept its rounds and the bare loop
had its core and the machine nothing else to do; else the test says that it cannot judge. Busy: one
process that never rests runs beside, and the bare loop is the one of the quiet minute before: the
harness must come within 10 % of it, or give no figure and the reason.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from bench.measure.latency import Timing, TimingTarget, measure
from bench.measure.quiet import Load, Patience

WIDTH = 157
TRIES = 2
PATIENCE_S = 20.0
PROCESSES = 3
OPENER = """
import onnxruntime

def open_session(path, threads):
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = threads
    session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
    return lambda x: session.run(None, {"x": x})[0]
"""
BARE_LOOP = """
import sys, time
import numpy as np, psutil
from session_opener import open_session
path, batch, width, core = sys.argv[1], *map(int, sys.argv[2:])
if core >= 0:
    psutil.Process().cpu_affinity([core])
run = open_session(path, 1)
x = np.random.default_rng(0).random((batch, width), dtype=np.float32)
for _ in range(500):
    run(x)
print("ready", flush=True)
for _ in sys.stdin:
    for _ in range(200):
        run(x)
    start, busy = time.perf_counter(), time.process_time()
    for _ in range(30):
        run(x)
    passed, busy = time.perf_counter() - start, time.process_time() - busy
    print(passed / 30 * 1e6, busy / passed, flush=True)
"""


def _network(path: Path, layers: int) -> None:
    """Write a convolutional network of about REMnet's size: 16 channels, kernel 3."""
    rng = np.random.default_rng(0)
    weights = [numpy_helper.from_array(np.array([1]), "one")]
    weights.append(numpy_helper.from_array(np.array([1, 2]), "axes"))
    nodes = [helper.make_node("Unsqueeze", ["x", "one"], ["h0"])]
    for k in range(layers):
        kernel = 0.1 * rng.normal(size=(16, 16 if k else 1, 3))
        weights.append(numpy_helper.from_array(kernel.astype(np.float32), f"w{k}"))
        nodes.append(helper.make_node("Conv", [f"h{k}", f"w{k}"], [f"c{k}"], pads=[1, 1]))
        nodes.append(helper.make_node("Relu", [f"c{k}"], [f"h{k + 1}"]))
    nodes.append(helper.make_node("ReduceMean", [f"h{layers}", "axes"], ["y"], keepdims=0))
    graph = helper.make_graph(
        nodes,
        "truth",
        [helper.make_tensor_value_info("x", TensorProto.FLOAT, ["rows", WIDTH])],
        [helper.make_tensor_value_info("y", TensorProto.FLOAT, ["rows"])],
        weights,
    )
    onnx.save(
        helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=10), path
    )


class BareLoop:
    """A process that loops 30 times over the session whenever it is asked."""

    def __init__(self, path: Path, batch: int, core: int) -> None:
        command = [sys.executable, "-c", BARE_LOOP, str(path), str(batch), str(WIDTH), str(core)]
        environment = {**os.environ, "PYTHONPATH": str(path.parent), "OMP_NUM_THREADS": "1"}
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )
        assert self.process.stdout.readline() == "ready\n"

    def time(self) -> tuple[float, float]:
        """Return microseconds a call and the share of the core the loop had."""
        self.process.stdin.write("go\n")
        self.process.stdin.flush()
        passed_us, share = self.process.stdout.readline().split()
        return float(passed_us), float(share)


def _turn(
    path: Path, batch: int, patience_s: float
) -> tuple[list[Timing], list[list[tuple[float, float]]], float]:
    """Return what the harness reports, the bare loops between its rounds, and others' cores."""
    core = max(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else -1
    loops = [BareLoop(path, batch, core) for _ in range(PROCESSES)]
    bare: list[list[tuple[float, float]]] = [[] for _ in loops]

    def between_rounds(_: float) -> None:
        for loop, times in zip(loops, bare, strict=True):
            times.extend(loop.time() for _ in range(2))

    load = Load()
    targets = [TimingTarget(path, "session_opener:open_session", WIDTH)] * PROCESSES
    found = measure(
        targets,
        rounds=20,
        batches=[batch],
        progress=between_rounds,
        patience=Patience(patience_s),
    )
    others = load.others()
    for loop in loops:
        loop.process.kill()
    assert all(isinstance(one, Timing) for one in found)
    return found, bare, others


@pytest.fixture
def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a maker of files with a network of so many layers."""
    (tmp_path / "session_opener.py").write_text(OPENER)
    monkeypatch.syspath_prepend(tmp_path)

    def make(layers: int) -> Path:
        _network(tmp_path / "truth.onnx", layers)
        return tmp_path / "truth.onnx"

    return make


def _reported_us(found: list[Timing]) -> float | None:
    """Return the median over processes of the medians; None where one of them has no figure."""
    if any(one.withheld or one.latency[0].unstable for one in found):
        return None
    return float(np.median([one.latency[0].median_us for one in found]))


def _quiet_turn(path: Path, batch: int) -> tuple[float, float] | None:
    """Return reported and bare microseconds of a turn in which nothing else ran, None if busy."""
    found, bare, others = _turn(path, batch, patience_s=PATIENCE_S)
    reported_us = _reported_us(found)
    bare_us, share = np.median(np.median(bare, axis=1), axis=0)
    kept = [f"{one.rounds - one.dropped}/{one.rounds}" for one in found]
    print(
        f"\nbatch {batch}: reported {reported_us} us, bare {bare_us:.1f} us, rounds kept {kept}, "
        f"others used {others:.2f} cores",
        end="",
    )
    quiet = reported_us is not None and share > 0.97 and others <= Load().limit
    return (reported_us, float(bare_us)) if quiet else None


@pytest.mark.parametrize(("layers", "batch"), [(2, 1), (8, 4)], ids=["quick", "slow"])
def test_reported_latency_is_within_3_percent_of_a_bare_loop(layers, batch, session) -> None:
    path = session(layers)
    for _ in range(TRIES):
        if both := _quiet_turn(path, batch):
            reported_us, bare_us = both
            print(f", ratio {reported_us / bare_us:.4f}", end="")
            assert abs(reported_us / bare_us - 1) <= 0.03
            return
    pytest.skip(f"cannot judge: the machine is too busy, {TRIES} measurements were disturbed")


def test_beside_a_busy_process_it_is_within_10_percent_or_there_is_no_figure(session) -> None:
    path = session(8)
    quiet = _quiet_turn(path, 1)
    busy = subprocess.Popen([sys.executable, "-c", "while True: sum(range(10**6))"])
    try:
        found, _, others = _turn(path, 1, patience_s=5)
    finally:
        busy.kill()
        busy.wait()
    reported_us = _reported_us(found)
    print(
        f"\nbeside a busy process ({others:.2f} cores): {reported_us}, {found[0].withheld}", end=""
    )
    if reported_us is None:
        assert all(one.withheld is None or "busy" in one.withheld for one in found)
        return
    if quiet is None:
        pytest.skip("cannot judge: no quiet minute to compare a figure with")
    assert abs(reported_us / quiet[1] - 1) <= 0.10
