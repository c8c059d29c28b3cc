"""REMnet: fused kernels against the eager loop of any tutorial, on the same cores, in one run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from zoo.modules.remnet import RemnetModule
from zoo.training.eager import FloatArray
from zoo.training.fused_remnet import fit as fast_remnet
from zoo.training.recipe import TrainingRecipe

THREADS = 2
RECIPE = TrainingRecipe("mae", 3e-4, 32, 1)
DEMO_ROWS, DEMO_EPOCHS = 36_023, 3  # of the 30 epochs: each takes as long as the next


@pytest.fixture(autouse=True)
def _two_threads() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(THREADS)
    yield
    torch.set_num_threads(before)


def rows(count: int) -> tuple[FloatArray, FloatArray]:
    """CIRs whose error shows in where the energy lies."""
    generator = np.random.default_rng(0)
    delay = generator.exponential(4.0, count)
    taps = np.arange(128)
    decay = np.exp(-np.maximum(taps - 5 - delay[:, None], 0) / 20) * (taps > 5 + delay[:, None])
    X = decay * generator.rayleigh(1.0, (count, 128)) + generator.rayleigh(0.05, (count, 128))
    return X.astype(np.float32), (0.03 * delay).astype(np.float32)


def eager(module: nn.Module, X: FloatArray, y: FloatArray, epochs: int, seed: int) -> float:
    """Train plainly; return the last epoch's mean loss."""
    torch.manual_seed(seed)
    inputs, targets = torch.from_numpy(X), torch.from_numpy(y)
    adam = torch.optim.Adam(module.parameters(), RECIPE.learning_rate)
    for _ in range(epochs):
        total = 0.0
        for batch in torch.randperm(len(inputs)).split(RECIPE.batch_size):
            adam.zero_grad()
            loss = nn.functional.l1_loss(module(inputs[batch]), targets[batch])
            loss.backward()
            adam.step()
            total += loss.item() * len(batch)
    return total / len(inputs)


def fused(module: RemnetModule, X: FloatArray, y: FloatArray, epochs: int, seed: int) -> float:
    return fast_remnet.train(module, X, y, replace(RECIPE, epochs=epochs, seed=seed)).epoch_losses[
        -1
    ]


def seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def test_fused_is_three_times_eager() -> None:
    X, y = rows(960)
    fused(RemnetModule(), X, y, 1, 0)  # the compiler's time is in the next test
    times = [
        (seconds(lambda: eager(RemnetModule(), X, y, 1, 0)),
         seconds(lambda: fused(RemnetModule(), X, y, 4, 0)) / 4)
        for _ in range(5)
    ]  # fmt: skip
    plain, quick = np.median(times, axis=0)
    ratio = np.median([a / b for a, b in times])
    print(f"\neager {len(y) / plain:.0f} rows/s, fused {len(y) / quick:.0f}: {ratio:.1f} times")
    assert ratio >= 3


def test_ten_networks_are_four_times_eager() -> None:
    X, y = rows(480)
    seeds = range(10)
    fused(RemnetModule(), X, y, 1, 0)
    one_eager = seconds(lambda: eager(RemnetModule(), X, y, 1, 0))
    modules = [RemnetModule(seed=seed) for seed in seeds]
    together = seconds(lambda: fast_remnet.train_many(
        modules, [X] * 10, [y] * 10, RECIPE, seeds=seeds, threads=THREADS
    ))  # fmt: skip
    one_eager = (one_eager + seconds(lambda: eager(RemnetModule(), X, y, 1, 0))) / 2
    print(f"\nten networks: {10 * one_eager / together:.1f} times eager one by one")
    assert 10 * one_eager / together >= 4


def test_losses_agree_within_seed_noise() -> None:
    X, y = rows(1_500)
    runs = {
        engine.__name__: [engine(RemnetModule(seed=s), X, y, 4, s) for s in range(3)]
        for engine in (eager, fused)
    }
    spread = max(np.std(losses, ddof=1) for losses in runs.values())
    print(f"\nlast epoch's loss by seed: {runs}")
    assert abs(np.mean(runs["eager"]) - np.mean(runs["fused"])) < 3 * spread


def test_demo_from_cold(tmp_path: Path) -> None:
    """A tenth of the protocol in a fresh process with nothing compiled, timed, not asserted."""
    script = f"""
import json, sys, time
start = time.perf_counter()
sys.path.insert(0, "tests/benchmarks")
from test_training_speed import fused, rows
from zoo.modules.remnet import RemnetModule
X, y = rows({DEMO_ROWS})
loaded = time.perf_counter()
fused(RemnetModule(), X[:32], y[:32], 1, 0)
compiled = time.perf_counter()
fused(RemnetModule(), X, y, {DEMO_EPOCHS}, 0)
print(json.dumps([loaded - start, compiled - loaded, time.perf_counter() - compiled]))
"""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "OMP_NUM_THREADS": str(THREADS)}
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=True
    )
    load, compiling, training = json.loads(done.stdout.splitlines()[-1])
    rate = DEMO_ROWS * DEMO_EPOCHS / training
    print(f"\nimports {load:.1f} s, compiling {compiling:.1f} s, {DEMO_EPOCHS} epochs "
          f"{training:.1f} s ({rate:.0f} rows/s)")  # fmt: skip
