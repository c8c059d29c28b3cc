"""Stacked networks end as each would have alone."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from zoo.modules.remnet import RemnetModule
from zoo.training.eager import FloatArray, train
from zoo.training.fused_remnet import fit as fast_remnet
from zoo.training.recipe import TrainingRecipe
from zoo.training.stacked.fit import train_stacked, why_not

RECIPE = TrainingRecipe("mae", 1e-3, 16, 3)
SEEDS = [3, 1, 4]


class _Scaled(nn.Module):
    """A network with a constant of its own in a buffer."""

    def __init__(self, scale: float) -> None:
        super().__init__()
        self.register_buffer("scale", torch.tensor(scale))
        self.layers = nn.Sequential(nn.Linear(20, 8), nn.ReLU(), nn.Linear(8, 1))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.layers(x * self.scale).squeeze(-1)


def mlp(seed: int) -> nn.Module:
    return seeded(seed, lambda: nn.Sequential(
        nn.Linear(20, 12), nn.ReLU(), nn.Dropout(0.4), nn.Linear(12, 6), nn.ReLU(),
        nn.Dropout(0.2), nn.Linear(6, 1), nn.Flatten(0),
    ))  # fmt: skip


def cnn(seed: int) -> nn.Module:
    return seeded(seed, lambda: nn.Sequential(
        nn.Unflatten(1, (1, 20)), nn.Conv1d(1, 4, 3), nn.ReLU(), nn.MaxPool1d(2), nn.Dropout(0.3),
        nn.Conv1d(4, 4, 3), nn.ReLU(), nn.Flatten(), nn.Linear(28, 1), nn.Flatten(0),
    ))  # fmt: skip


def narrow_remnet(seed: int) -> nn.Module:
    return RemnetModule(20, 8, 2, 4, seed=seed)


def scaled(seed: int) -> nn.Module:
    return seeded(seed, lambda: _Scaled(0.5 + seed))


def seeded(seed: int, make: Callable[[], nn.Module]) -> nn.Module:
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        return make()


def rows(count: int, samples: int = 20, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    X = np.random.default_rng(seed).standard_normal((count, samples)).astype(np.float32)
    return X, (0.1 * X[:, 0] - 0.05 * X[:, 3]).astype(np.float32)


def predictions(module: nn.Module, X: FloatArray) -> np.ndarray:
    with torch.no_grad():
        return module(torch.from_numpy(X)).numpy()


@pytest.mark.parametrize("loss", ["mae", "mse", nn.functional.huber_loss])
@pytest.mark.parametrize("make", [mlp, cnn, narrow_remnet, scaled])
def test_ends_as_alone(make: Callable[[int], nn.Module], loss: object) -> None:
    X, y = rows(70)  # the last batch has six rows
    together, alone = ([make(seed) for seed in SEEDS] for _ in "ab")
    assert why_not(together, [X] * 3) is None
    recipe = replace(RECIPE, loss=loss)
    logs = train_stacked(together, X, y, recipe, seeds=SEEDS)
    for module, other, seed, log in zip(together, alone, SEEDS, logs, strict=True):
        expected = train(other, X, y, replace(recipe, seed=seed))
        assert log.engine == "stacked"
        assert not module.training
        assert log.epoch_losses == pytest.approx(expected.epoch_losses, abs=1e-5)
        assert predictions(module, X) == pytest.approx(predictions(other, X), abs=1e-4)


def test_networks_may_have_different_rows() -> None:
    data = [rows(count, seed=count) for count in (70, 16, 37)]
    together, alone = ([mlp(seed) for seed in SEEDS] for _ in "ab")
    logs = train_stacked(together, [X for X, _ in data], [y for _, y in data], RECIPE, seeds=SEEDS)
    for module, other, seed, log, (X, y) in zip(together, alone, SEEDS, logs, data, strict=True):
        expected = train(other, X, y, replace(RECIPE, seed=seed))
        assert log.rows == len(y)
        assert log.epoch_losses == pytest.approx(expected.epoch_losses, abs=1e-5)
        assert predictions(module, X) == pytest.approx(predictions(other, X), abs=1e-4)


def test_trained_networks_share_no_memory() -> None:
    X, y = rows(20)
    modules = [mlp(seed) for seed in SEEDS]
    train_stacked(modules, X, y, RECIPE, seeds=SEEDS)
    before = predictions(modules[1], X)
    nn.init.zeros_(modules[0][0].weight)  # type: ignore[index]
    assert np.array_equal(before, predictions(modules[1], X))


def test_remnets_go_to_the_fused_kernels() -> None:
    X, y = rows(70, samples=32)
    together, alone = ([RemnetModule(32, seed=seed) for seed in SEEDS] for _ in "ab")
    logs = train_stacked(together, X, y, RECIPE, seeds=SEEDS)
    for module, other, seed, log in zip(together, alone, SEEDS, logs, strict=True):
        expected = fast_remnet.train(other, X, y, replace(RECIPE, seed=seed))
        assert log.engine == "fused"
        assert log.epoch_losses == expected.epoch_losses
        assert np.array_equal(predictions(module, X), predictions(other, X))


def batch_norm() -> nn.Module:
    return nn.Sequential(nn.Linear(20, 4), nn.BatchNorm1d(4), nn.Linear(4, 1), nn.Flatten(0))


@pytest.mark.parametrize(
    ("modules", "part"),
    [
        ([mlp(0)], "nothing to stack"),
        ([mlp(0), scaled(0)], "differ"),
        ([batch_norm(), batch_norm()], "changes during training"),
        ([nn.Sequential(nn.Linear(20, 1), nn.AlphaDropout(), nn.Flatten(0)) for _ in "ab"],
         "AlphaDropout"),
        ([mlp(0).double(), mlp(1).double()], "float32"),
    ],
)  # fmt: skip
def test_says_why_not(modules: list[nn.Module], part: str) -> None:
    reason = why_not(modules, [rows(20)[0]] * len(modules))
    assert reason is not None
    assert part in reason


def test_what_cannot_be_stacked_is_trained_in_turn() -> None:
    X, y = rows(40)
    together, fractions = [mlp(0), scaled(1)], list[float]()
    alone = copy.deepcopy(together)
    logs = train_stacked(together, X, y, RECIPE, seeds=[0, 1], progress=fractions.append)
    for module, other, seed, log in zip(together, alone, [0, 1], logs, strict=True):
        train(other, X, y, replace(RECIPE, seed=seed))
        assert log.engine == "eager"
        assert np.array_equal(predictions(module, X), predictions(other, X))
    assert fractions == [0.5, 1.0]


def test_random_state_stays_and_progress_reaches_one() -> None:
    state, fractions = torch.get_rng_state(), list[float]()
    modules = [mlp(seed) for seed in SEEDS]
    train_stacked(modules, *rows(20), RECIPE, seeds=SEEDS, progress=fractions.append)
    assert torch.equal(state, torch.get_rng_state())
    assert fractions[-1] == 1.0


def test_refuses_unequal_numbers() -> None:
    X, y = rows(20)
    modules = [mlp(seed) for seed in SEEDS]
    with pytest.raises(ValueError, match="2 seeds"):
        train_stacked(modules, X, y, RECIPE, seeds=[1, 2])
    with pytest.raises(ValueError, match="1 arrays"):
        train_stacked(modules, [X], y, RECIPE, seeds=SEEDS)
