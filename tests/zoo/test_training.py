"""The plain training loop."""

from __future__ import annotations

import copy

import numpy as np
import pytest
import torch
from torch import nn

from zoo.training.eager import FloatArray, TrainingLog, epoch_orders, train

OPTIONS = {"learning_rate": 1e-2, "batch_size": 16, "epochs": 3}


def network(rate: float = 0.0) -> nn.Module:
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        layers = [nn.Linear(6, 8), nn.ReLU(), nn.Dropout(rate), nn.Linear(8, 1), nn.Flatten(0)]
        return nn.Sequential(*layers)


def rows(count: int) -> tuple[FloatArray, FloatArray]:
    X = np.random.default_rng(1).standard_normal((count, 6)).astype(np.float32)
    return X, X.sum(axis=1)


def same(a: nn.Module, b: nn.Module) -> bool:
    return all(torch.equal(p, q) for p, q in zip(a.parameters(), b.parameters(), strict=True))


def reference(module: nn.Module, X: FloatArray, y: FloatArray, seed: int, decay: float) -> None:
    """The loop of any tutorial."""
    adam = torch.optim.Adam(module.parameters(), OPTIONS["learning_rate"], weight_decay=decay)
    for order in epoch_orders(len(y), OPTIONS["epochs"], seed):
        for start in range(0, len(y), OPTIONS["batch_size"]):
            batch = order[start : start + OPTIONS["batch_size"]]
            adam.zero_grad()
            predicted = module(torch.from_numpy(X[batch]))
            nn.functional.mse_loss(predicted, torch.from_numpy(y[batch])).backward()
            adam.step()


@pytest.mark.parametrize("decay", [0.0, 0.1])
def test_takes_the_steps_of_a_tutorial_loop(decay: float) -> None:
    X, y = rows(70)  # the last batch has six rows
    ours, theirs = network(), network()
    train(ours, X, y, loss="mse", seed=5, weight_decay=decay, **OPTIONS)
    reference(theirs, X, y, seed=5, decay=decay)
    for a, b in zip(ours.parameters(), theirs.parameters(), strict=True):
        assert a.detach().numpy() == pytest.approx(b.detach().numpy(), abs=1e-5)


def test_the_seed_decides_everything() -> None:
    a, b, c = network(0.5), network(0.5), network(0.5)
    X, y = rows(70)
    for module, seed in ((a, 1), (b, 1), (c, 2)):
        torch.manual_seed(int(torch.randint(1000, ())))  # the global state must not matter
        train(module, X, y, loss="mae", seed=seed, **OPTIONS)
    assert same(a, b)
    assert not same(a, c)


def test_global_random_state_stays() -> None:
    state = torch.get_rng_state()
    train(network(0.5), *rows(20), loss="mae", seed=1, **OPTIONS)
    assert torch.equal(state, torch.get_rng_state())


def test_log_and_progress() -> None:
    fractions: list[float] = []
    module = network()
    log = train(module, *rows(70), loss="mse", seed=1, progress=fractions.append, **OPTIONS)
    assert isinstance(log, TrainingLog)
    assert log.engine == "eager"
    assert log.rows == 70
    assert fractions == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert len(log.epoch_losses) == 3
    assert log.epoch_losses[-1] < log.epoch_losses[0]
    assert log.rows_per_second > 0
    assert not module.training


def test_loss_may_be_a_function_and_parameters_frozen() -> None:
    module, same_module = network(), network()
    frozen = copy.deepcopy(module[0])  # type: ignore[index]
    for parameter in module[0].parameters():  # type: ignore[index]
        parameter.requires_grad_(False)
    train(module, *rows(20), loss=nn.functional.huber_loss, seed=1, **OPTIONS)
    assert same(module[0], frozen)
    assert not same(module, same_module)


@pytest.mark.parametrize(
    ("X", "y", "change", "message"),
    [
        (np.zeros((0, 6)), np.zeros(0), {}, "no rows"),
        (np.zeros((4, 6)), np.zeros(3), {}, "do not match"),
        (np.zeros((4, 6)), np.zeros((4, 1)), {}, "do not match"),
        (np.zeros((4, 6)), np.zeros(4), {"batch_size": 0}, "positive"),
        (np.zeros((4, 6)), np.zeros(4), {"epochs": 0}, "positive"),
        (np.zeros((4, 6)), np.zeros(4), {"loss": "mea"}, "known: mae, mse"),
    ],
)
def test_refuses(X: FloatArray, y: FloatArray, change: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        train(network(), X, y, seed=0, **({"loss": "mae"} | OPTIONS | change))
