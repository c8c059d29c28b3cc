"""Twenty perceptrons and ten REMnets trained together, against one by one, in one run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pytest
import torch
from quietly import hold

from bench.measure.quiet import Load
from bench.reproduce.raw_mlp import RawMLP
from zoo import REMnet
from zoo.base import Floats
from zoo.module_model import NeuralModel
from zoo.training.eager import train
from zoo.training.together import fit_together

ROWS, FEW_ROWS = 960, 128  # few: the plain loop takes seconds per REMnet and epoch
ROUNDS, FEW_ROUNDS = 5, 3
NEEDED = 4.0
PERCEPTRONS_NEEDED = 3.0  # 3.4 to 4.2 by round on a quiet machine: one fit is fast already
SAME_M = 1e-4


@pytest.fixture(autouse=True)
def _two_threads() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    yield
    torch.set_num_threads(before)


def made_up(rows: int = ROWS) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(0)
    cirs = rng.rayleigh(100, (rows, 157)).astype(np.float32)
    return cirs, (cirs[:, 5:9].mean(axis=1) / 1000).astype(np.float32)


def perceptrons() -> Sequence[NeuralModel]:
    return [RawMLP(epochs=1, random_state=seed) for seed in range(20)]


def remnets() -> Sequence[NeuralModel]:
    return [REMnet(epochs=1, random_state=seed) for seed in range(10)]


def one_by_one(models: Sequence[NeuralModel], X: Floats, y: Floats) -> None:
    for model in models:
        model.fit(X, y)


def in_the_plain_loop(models: Sequence[NeuralModel], X: Floats, y: Floats) -> None:
    """Train in torch, step by step, whatever kernels the model has of its own."""
    for model in models:
        start = model.prepare(X, y)
        train(start.module.network, start.rows, start.errors_m, model.seeded_recipe())


def together(models: Sequence[NeuralModel], X: Floats, y: Floats) -> None:
    fit_together(models, [X] * len(models), [y] * len(models))


def ratio(
    make: Callable[[], Sequence[NeuralModel]],
    alone: Callable[[Sequence[NeuralModel], Floats, Floats], None],
    what: str,
    rows: int = ROWS,
    rounds: int = ROUNDS,
) -> float:
    """Return how many times faster together is, each at its best: other work only ever adds.

    The first round warms up.
    """
    X, y = made_up(rows)
    times = []
    for _ in range(rounds + 1):
        start = time.perf_counter()
        alone(make(), X, y)
        middle = time.perf_counter()
        together(make(), X, y)
        times.append((middle - start, time.perf_counter() - middle))
    alone_s, together_s = np.min(times[1:], axis=0)
    each = ", ".join(f"{one / all_:.1f}" for one, all_ in times[1:])
    print(f"\n{what}: {alone_s / together_s:.1f} times (by round {each})")
    return float(alone_s / together_s)


def largest_gap_m(make: Callable[[], Sequence[NeuralModel]]) -> float:
    """Return the largest difference of a seed's MAE, trained together and alone."""
    X, y = made_up()
    pair = make(), make()
    one_by_one(pair[0], X, y)
    together(pair[1], X, y)
    maes = np.array([[np.abs(y - one.predict(X)).mean() for one in models] for models in pair])
    return float(np.abs(maes[0] - maes[1]).max())


def test_twenty_perceptrons_are_three_times_one_by_one() -> None:
    assert largest_gap_m(perceptrons) <= SAME_M
    load = Load()
    found = ratio(perceptrons, one_by_one, "20 perceptrons, together against fit")
    hold(found >= PERCEPTRONS_NEEDED, f"{found:.1f} times", load)


def test_ten_remnets_are_four_times_the_plain_loop() -> None:
    """`fit` is fused already: against that, together wins by its threads alone (2.0 times)."""
    assert largest_gap_m(remnets) <= SAME_M
    what, load = "10 REMnets, together against plain", Load()
    plain = ratio(remnets, in_the_plain_loop, what, FEW_ROWS, FEW_ROUNDS)
    hold(plain >= NEEDED, f"{plain:.1f} times", load)
