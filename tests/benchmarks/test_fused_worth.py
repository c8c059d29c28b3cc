"""What the hand-written vectors are worth against plain numba with BLAS."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from torch import nn

sys.path.insert(0, str(Path(__file__).parent))
from plain_numba_remnet import PlainNumba, gradient

from zoo.modules.remnet import RemnetModule
from zoo.training.fused_remnet import fit as fused_remnet
from zoo.training.recipe import TrainingRecipe

RECIPE = TrainingRecipe("mae", 3e-4, 32, 1)
ROWS, ROUNDS = 1920, 5


def rows(count: int) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(0)
    X = generator.rayleigh(1.0, (count, 128)).astype(np.float32)
    return X, generator.normal(0.1, 0.1, count).astype(np.float32)


def seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def test_the_plain_version_is_the_same_network() -> None:
    module, (X, y) = RemnetModule(seed=3, dropout=0.0), rows(32)
    nn.functional.l1_loss(module(torch.from_numpy(X)), torch.from_numpy(y)).backward()
    plain = PlainNumba(module)
    gradient(X, y, np.ones((32, 256), np.float32), plain.p, plain.g)
    first, wide = module.first.weight.grad, module.rrms[1].wide.weight.grad
    assert np.allclose(plain.g[0][0], first.permute(2, 1, 0).reshape(7, 16), rtol=1e-3, atol=1e-6)
    assert np.allclose(plain.g[2][2], wide.permute(2, 1, 0).reshape(48, 16), rtol=1e-3, atol=1e-6)


def test_vectors_are_worth_more_than_twice_plain_numba_with_blas() -> None:
    X, y = rows(ROWS)
    plain = PlainNumba(RemnetModule())

    def fused() -> float:
        return seconds(lambda: fused_remnet.train(RemnetModule(), X, y, RECIPE))

    def blas() -> float:
        return seconds(lambda: plain.train(X, y, epochs=1, batch=32, rate=3e-4, seed=0))

    fused(), blas()  # compiling
    times = np.array([(blas(), fused()) for _ in range(ROUNDS)])
    plain_s, fused_s = np.median(times, axis=0)
    ratio = np.median(times[:, 0] / times[:, 1])
    print(f"\nrows/s: plain numba with BLAS {ROWS / plain_s:.0f}, vectors {ROWS / fused_s:.0f}: "
          f"{ratio:.1f} times")  # fmt: skip
    assert ratio > 2  # or they would not be kept
