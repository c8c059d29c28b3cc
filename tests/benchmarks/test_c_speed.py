"""Latency of C through ctypes against ONNX Runtime fp32, batch 1, as ratios within one run.

The artifacts take turns in one process on one thread; the tenth percentile of the calls of each is
compared, as in test_backend_speed.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from backends.base import TrainingData
from backends.c.compile import FLAGS, missing_compiler
from backends.c.emit import generate
from backends.c.run import load
from backends.fp32 import Fp32Backend
from backends.int8 import Int8Backend
from backends.ort import open_optimised, open_plain
from zoo.base import Floats
from zoo.cnn1d import CNN1D
from zoo.mlp import FeatureMLP
from zoo.remnet import REMnet

pytestmark = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
WIDTH, TURN, SECONDS = 157, 40, 8.0
WIDTHS = {  # instruction set -> highest ratio to ONNX Runtime fp32, and what tells it is there
    "x86-64": (0.60, "sse2"),
    "x86-64-v3": (0.30, "avx2"),
    "x86-64-v4": (0.20, "avx512f"),
}


def _cirs(rows: int) -> Floats:
    rng = np.random.default_rng(rows)
    level = 100 + 10_000 * np.exp(-np.maximum(np.arange(WIDTH) - 5, 0) / 20)
    return (level * rng.rayleigh(1, (rows, WIDTH))).astype(np.float32)


def _data() -> TrainingData:
    rows = _cirs(300)
    return TrainingData(rows, rows[:, 5] / 1e6, seed=0)


def _latencies_us(runners: dict[str, Callable[[Floats], Floats]], rows: Floats) -> dict[str, float]:
    clock, calls = time.perf_counter_ns, {name: [] for name in runners}
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        for name, run in runners.items():
            for _ in range(5):
                run(rows)
            for _ in range(TURN):
                start = clock()
                run(rows)
                calls[name].append(clock() - start)
    return {name: float(np.percentile(spans, 10)) / 1e3 for name, spans in calls.items()}


def _processor() -> str:
    path = Path("/proc/cpuinfo")
    return path.read_text() if path.is_file() else ""


def test_remnet_as_c_is_faster_than_onnx_runtime_at_every_vector_width(tmp_path: Path) -> None:
    data, path = _data(), tmp_path / "model.onnx"
    Fp32Backend().build(REMnet(epochs=1).fit(data.cirs, data.errors_m), data, path)
    source = generate(path, "fp32")
    here = {name: bar for name, (bar, flag) in WIDTHS.items() if flag in _processor()}
    if not here:
        pytest.skip("no x86 processor, or none that says what it has")
    runners = {name: load(source, (*FLAGS, f"-march={name}")) for name in here}
    runners = {"runtime": open_plain(path), "optimised": open_optimised(path), **runners}
    found = _latencies_us(runners, _cirs(1))
    ratios = {name: us / found["runtime"] for name, us in found.items()}
    print("\nREMnet fp32:", {k: f"{found[k]:.1f} us, {ratios[k]:.2f}" for k in found})
    for name, bar in here.items():
        assert ratios[name] <= bar


@pytest.mark.parametrize(
    ("model", "share"),
    [(REMnet(epochs=2), 1.0), (CNN1D(epochs=2), 1.0), (FeatureMLP(epochs=2), 0.999)],
    ids=["remnet", "cnn1d", "mlp"],
)
def test_8_bit_c_equals_the_runtime_on_4096_rows(model, share, tmp_path: Path) -> None:
    data, path, rows = _data(), tmp_path / "model.onnx", _cirs(4096)
    Int8Backend().build(model.fit(data.cirs, data.errors_m), data, path)
    expected = open_optimised(path)(rows)
    for requantise in ("float", "fixed"):
        found = load(generate(path, "int8", requantise))(rows)
        equal, largest = np.mean(found == expected), np.abs(found - expected).max()
        print(f"\n{requantise}: {100 * equal:.2f} % equal, at most {largest * 1e3:.3g} mm")
        assert equal >= (share if requantise == "float" else 0.999)
        assert largest <= 1e-3 or requantise == "float"
