"""Eighteen blurred perceptrons at once, against the plain loop one by one, in one run."""

from __future__ import annotations

import time

import numpy as np
import torch

from zoo.modules.bagged import BaggedNetwork, Members
from zoo.training.bagged import Bagging, train_bagged
from zoo.training.recipe import TrainingRecipe

COLUMNS, MEMBERS, HIDDEN, BATCH, STEPS, ROUNDS = 32, 18, 10, 64, 200, 3
NOISES = (0.3, 0.6, 1.2)
RECIPE = TrainingRecipe("mae", 3e-3, BATCH, 1, weight_decay=1e-3)
NEEDED = 4.0


def made_up() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(2000, COLUMNS)).astype(np.float32)
    return rows, (0.2 * rows[:, 0]).astype(np.float32), np.arange(2000) % 20


def one_by_one(rows: np.ndarray, errors: np.ndarray) -> None:
    inputs, targets = torch.from_numpy(rows), torch.from_numpy(errors)
    for member in range(MEMBERS):
        network = Members(torch.ones(1, COLUMNS), HIDDEN, torch.zeros(1), member)
        adam = torch.optim.AdamW(network.parameters(), weight_decay=1e-3, fused=True)
        for _ in range(STEPS):
            chosen = torch.randint(0, len(inputs), (1, BATCH))
            x = inputs[chosen]
            loss = (network(x + torch.randn(x.shape)) - targets[chosen]).abs().mean()
            adam.zero_grad()
            loss.backward()
            adam.step()


def test_at_once_is_four_times_one_by_one() -> None:
    """Each at its best: other work on the machine only ever adds."""
    rows, errors, links = made_up()
    times = []
    for _ in range(ROUNDS + 1):
        start = time.perf_counter()
        one_by_one(rows, errors)
        middle = time.perf_counter()
        network = BaggedNetwork(COLUMNS, MEMBERS, HIDDEN)
        train_bagged(network, rows, errors, RECIPE, Bagging(NOISES, STEPS), groups=links)
        times.append((middle - start, time.perf_counter() - middle))
    alone_s, at_once_s = np.min(times[1:], axis=0)  # the first warms up
    print(f"\n18 perceptrons at once: {alone_s / at_once_s:.1f} times one by one, "
          f"{MEMBERS * BATCH * STEPS / at_once_s:.0f} rows/s")  # fmt: skip
    assert alone_s / at_once_s >= NEEDED
