"""Twenty small networks stacked, against the plain loop one by one, in one run."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np
import pytest
import torch
from torch import nn

from zoo.stacked_training import train_stacked
from zoo.training import train

OPTIONS = {"loss": "mae", "learning_rate": 1e-3, "batch_size": 32, "epochs": 1}
NETWORKS = 20


@pytest.fixture(autouse=True)
def _two_threads() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    yield
    torch.set_num_threads(before)


def mlps() -> list[nn.Module]:
    torch.manual_seed(0)
    return [
        nn.Sequential(*_layer(157, 64), *_layer(64, 64), nn.Linear(64, 1), nn.Flatten(0))
        for _ in range(NETWORKS)
    ]


def _layer(inputs: int, outputs: int) -> tuple[nn.Module, nn.Module]:
    return nn.Linear(inputs, outputs), nn.ReLU()


def test_twenty_mlps_are_four_times_one_by_one() -> None:
    generator = np.random.default_rng(0)
    X = generator.standard_normal((960, 157)).astype(np.float32)
    y = X[:, :3].sum(axis=1)
    ratios = []
    for _ in range(5):
        start = time.perf_counter()
        for seed, module in enumerate(mlps()):
            train(module, X, y, seed=seed, **OPTIONS)
        middle = time.perf_counter()
        train_stacked(mlps(), X, y, seeds=range(NETWORKS), **OPTIONS)
        ratios.append((middle - start) / (time.perf_counter() - middle))
    print(f"\nstacked: {np.median(ratios):.1f} times one by one ({min(ratios):.1f} at worst)")
    assert np.median(ratios) >= 4
