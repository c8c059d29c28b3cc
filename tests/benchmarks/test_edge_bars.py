"""REMnet from a finished run to firmware: how long it takes, and what it takes on the cores.

Sizes and cycles are those of the typical column, without a part's wait states; they depend on the
network's shape and hardly on its weights, so that one epoch on made-up rows will do.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from quietly import hold

from backends.base import Artifact, TrainingData
from backends.c.emit import generate
from backends.fp32 import Fp32Backend
from backends.int8 import Int8Backend
from bench.errors import BenchError
from bench.files import cache_dir
from bench.measure.counting import build_image, count_image, load_core
from bench.measure.counting.compile import Which
from bench.measure.quiet import Load
from zoo.base import Floats
from zoo.remnet import REMnet

resource = pytest.importorskip("resource", reason="no processor times of children here")
BENCH = str(Path(sys.executable).parent / "bench")
EXPORT_S, COUNT_S = 3.0, 60.0
KIB = 1024
BARS = [  # backend, core, compiler, flash and arena (KB), cycles (millions)
    ("int8", "cortex-m4f", "gcc", 14, 4.5, 1.0),
    ("fp32", "cortex-m4f", "gcc", 30, 17, 1.1),
    ("int8", "cortex-m4f", "zig", None, 4.5, 1.3),
    ("fp32", "cortex-m4f", "zig", None, 17, 1.3),
    ("int8", "cortex-m0plus", "gcc", None, 4.5, 3.5),
]


def _cirs(rows: int) -> Floats:
    rng = np.random.default_rng(rows)
    level = 100 + 10_000 * np.exp(-np.maximum(np.arange(157) - 5, 0) / 20)
    return (level * rng.rayleigh(1, (rows, 157))).astype(np.float32)


@pytest.fixture(scope="module")
def artifacts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Artifact]:
    folder, rows = tmp_path_factory.mktemp("remnet"), _cirs(300)
    data = TrainingData(rows, rows[:, 5] / 1e6, seed=0)
    model = REMnet(epochs=1).fit(data.cirs, data.errors_m)
    backends = (Fp32Backend(), Int8Backend())
    return {one.name: one.build(model, data, folder / f"{one.name}.onnx") for one in backends}


@pytest.mark.parametrize(("backend", "core", "which", "flash", "arena", "cycles"), BARS)
def test_remnet_on_a_core(
    backend: str,
    core: str,
    which: Which,
    flash: float | None,
    arena: float,
    cycles: float,
    artifacts: dict[str, Artifact],
) -> None:
    to, rows = load_core(core), _cirs(2)
    how = "float" if to.float_unit else "fixed"
    source = generate(artifacts[backend].path, artifacts[backend].precision, how)
    try:
        count = count_image(build_image(dict(source.files), to, which), to, rows)
    except BenchError as problem:
        pytest.skip(str(problem))
    sizes = f"{count.flash_bytes / KIB:.1f} KB flash, {source.arena_bytes / KIB:.1f} KB arena"
    print(f"\n{backend} {core} {which}: {sizes}, {count.cycles.typical / 1e6:.3f} M cycles", end="")
    assert flash is None or count.flash_bytes <= flash * KIB
    assert source.arena_bytes <= arena * KIB
    assert count.cycles.typical <= cycles * 1e6
    if how == "float":
        np.testing.assert_allclose(count.outputs_m, artifacts[backend].predict(rows), atol=1e-5)


def _timed(*words: str) -> tuple[float, float]:
    """Return clock and processor seconds of a command."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([BENCH, *words], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - start, used


def test_export_and_count_are_quick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine the processor's seconds must say so, and the clock is their echo."""
    monkeypatch.setenv("BENCH_WAIT_S", "0")
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    run = ("run", "--model", "remnet", "--backend", "int8", "--out", str(tmp_path / "results"))
    subprocess.run([BENCH, *run], check=True, capture_output=True)
    [record] = (tmp_path / "results" / "runs").glob("*.json")
    words = ("--run", record.stem, "--results", str(tmp_path / "results"), "-o", str(tmp_path))
    load = Load()
    clock_s, used_s = min(_timed("export", *words) for _ in range(3))
    print(f"\nexport: {clock_s:.1f} s, {used_s:.1f} s of {os.cpu_count()} processors", end="")
    exported_s = min(clock_s, used_s)
    monkeypatch.setenv("BENCH_CACHE", str(_without_images(tmp_path / "cache")))
    words = ("--model", "remnet", "--backend", "c-int8", "--device", "nrf52832")
    clock_s, used_s = _timed("count", *words)
    print(f"\ncount: {clock_s:.1f} s, {used_s:.1f} s of processor", end="")
    assert min(clock_s, used_s) <= COUNT_S
    hold(exported_s <= EXPORT_S, f"export took {exported_s:.1f} s", load)


def _without_images(folder: Path) -> Path:
    """Return a cache like the one there is, in which nothing was compiled for a core yet."""
    folder.mkdir()
    for one in cache_dir().iterdir():
        if one.name != "images":
            (folder / one.name).symlink_to(one, target_is_directory=one.is_dir())
    return folder
