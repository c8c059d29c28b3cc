"""Rows a second of every newer model's training, against the plain loop or the library, in one run.

python -m pytest -s tests/benchmarks/test_every_training_speed.py
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
import torch
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel

import zoo
from zoo.base import Floats
from zoo.module_model import NeuralModel
from zoo.training.eager import loss_function, one_thread

ROWS, LINKS, LEVELS, STEPS, ROUNDS = 4000, 40, 8, 100, 3
LEAST = 0.8  # of the plain loop's speed: looks at held-out links and noise
NETWORKS: dict[str, Callable[[], NeuralModel]] = {
    "npn": lambda: zoo.NPN(most_steps=STEPS),
    "ecanet": lambda: zoo.ECANet(most_steps=STEPS),
    "bregar2023": lambda: zoo.Bregar2023(most_steps=STEPS),
    "remnet-levels": lambda: zoo.REMnetLevels(most_steps=STEPS),
    "small-cnn": lambda: zoo.SmallCNN(distilled=False, epochs=2),
}


def made_up(reads: tuple[str, ...]) -> tuple[Floats, Floats]:
    """Return CIRs, with levels and a range behind them where these are read, and errors."""
    rng = np.random.default_rng(0)
    cirs = rng.rayleigh(100, (ROWS, 157))
    levels = rng.normal(50, 5, (ROWS, LEVELS + 1))
    columns = [cirs] + ([levels] if "levels" in reads else [])
    return np.concatenate(columns, 1).astype(np.float32), (cirs[:, 5] / 1000).astype(np.float32)


def plain_s(model: NeuralModel, X: Floats, y: Floats) -> tuple[float, int]:
    """Train as any tutorial does, in one thread; return seconds and rows seen."""
    start, recipe = model.prepare(X, y), model.training_recipe()
    network, loss_of = start.module.network.train(), loss_function(recipe.loss)
    inputs, targets = torch.from_numpy(start.rows), torch.from_numpy(start.errors_m)
    adam = torch.optim.Adam(network.parameters(), recipe.learning_rate)
    began, total = time.perf_counter(), 0.0
    with one_thread():
        for _ in range(STEPS):
            chosen = torch.randint(0, len(inputs), (recipe.batch_size,))
            adam.zero_grad()
            loss = loss_of(network(inputs[chosen]), targets[chosen])
            loss.backward()
            adam.step()
            total += loss.item()
    return time.perf_counter() - began, STEPS * recipe.batch_size


@pytest.mark.parametrize("name", NETWORKS)
def test_a_network_trains_as_fast_as_the_plain_loop(name: str) -> None:
    model = NETWORKS[name]()
    X, y = made_up(model.reads)
    rates = []
    for _ in range(ROUNDS + 1):
        seconds, rows = plain_s(NETWORKS[name](), X, y)
        log = NETWORKS[name]().fit(X, y, groups=np.arange(ROWS) % LINKS).training_log_
        rates.append((rows / seconds, log.rows_per_second))
    plain, ours = np.median(rates[1:], axis=0)  # the first warms up
    ratio = np.median([b / a for a, b in rates[1:]])
    print(f"\n{name}: {ours:.0f} rows/s, plain loop {plain:.0f}: {ratio:.2f} times")
    assert ratio >= LEAST


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def library(name: str, X: Floats, y: Floats) -> None:
    """Fit the library's own on the raw columns."""
    if name == "gbm":
        HistGradientBoostingRegressor(
            loss="absolute_error", max_iter=200, max_leaf_nodes=15, early_stopping=False
        ).fit(X[:, -90:], y)
    elif name == "gp":
        GaussianProcessRegressor(RBF(4.0) + WhiteKernel(), optimizer=None).fit(X[:, -16:], y)
    else:
        np.median(y)


@pytest.mark.parametrize(
    ("name", "make", "least"),
    [
        ("gbm", zoo.GradientBoosting, 0.5),  # the features of the CIR come on top
        ("gp", zoo.GaussianProcess, 1.0),  # sparse against exact
        ("constant", zoo.Constant, None),
        ("constant-by-level", zoo.ConstantByLevel, None),
    ],
)
def test_a_fit_against_the_library(name: str, make: Callable[[], object], least: float) -> None:
    X, y = made_up(("cir", "levels"))
    X = X if name != "constant-by-level" else X[:, -LEVELS - 1 : -1]
    X = X if name != "constant" else X[:, :0].reshape(ROWS, 0)
    X = X if X.shape[1] else made_up(("cir", "levels"))[0][:, -1:]
    pairs = [
        (seconds(lambda: library(name, X, y)), seconds(lambda: make().fit(X, y)))  # type: ignore[attr-defined]
        for _ in range(ROUNDS)
    ]
    theirs, ours = np.median(pairs, axis=0)
    print(
        f"\n{name}: {ROWS / ours:.0f} rows/s, the library {ROWS / theirs:.0f}: {theirs / ours:.2f}"
    )
    assert least is None or theirs / ours >= least
