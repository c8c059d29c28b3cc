"""The fused REMnet kernels against autograd, and their promises about seeds."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from zoo.modules.remnet import RemnetModule
from zoo.training import eager as training
from zoo.training.eager import FloatArray
from zoo.training.fused_remnet import fit as fast_remnet
from zoo.training.fused_remnet.layout import flatten, layout_of, unflatten
from zoo.training.fused_remnet.network import FusedNetwork
from zoo.training.fused_remnet.steps import Data
from zoo.training.recipe import Stopping, TrainingRecipe

RECIPE = TrainingRecipe("mae", 3e-4, 32, 2)
SHAPES = [(128, 3, 8), (152, 3, 8), (37, 2, 4), (8, 3, 8), (5, 1, 16), (1, 1, 2)]


def rows(count: int, samples: int, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    generator = np.random.default_rng(seed)
    X = generator.standard_normal((count, samples)).astype(np.float32)
    return X, (X[:, 0] * 0.1 + generator.standard_normal(count) * 0.05).astype(np.float32)


class _Masked(nn.Module):
    """Dropout with the kernels' masks; they are [time, feature], torch's [feature, time]."""

    def __init__(self, draws: np.ndarray, rate: float) -> None:
        super().__init__()
        kept = draws.reshape(len(draws), -1, 16).swapaxes(1, 2).reshape(len(draws), -1)
        self.mask = torch.from_numpy((kept >= round(rate * 65536)) / np.float32(1 - rate)).float()

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x * self.mask


def autograd_gradient(module: RemnetModule, data: Data, weights: np.ndarray) -> np.ndarray:
    """The same batch through torch, flattened in the kernels' order."""
    layout, reference = layout_of(module), RemnetModule(*sizes(module), dropout=module.dropout.p)
    unflatten(weights, reference, layout)
    reference.dropout = _Masked(data.draws, module.dropout.p)
    predicted = reference(torch.from_numpy(data.signals))
    nn.functional.l1_loss(predicted, torch.from_numpy(data.errors)).backward()
    gradients = RemnetModule(*sizes(module))
    for into, of in zip(gradients.parameters(), reference.parameters(), strict=True):
        into.data.copy_(of.grad)
    return flatten(gradients, layout)


def sizes(module: RemnetModule) -> tuple[int, int, int, int]:
    return module.samples, module.features, len(module.rrms), module.reduction


@pytest.mark.parametrize("count", [1, 5, 32, 45])
@pytest.mark.parametrize(("samples", "modules", "reduction"), SHAPES)
def test_gradient_is_autograds(samples: int, modules: int, reduction: int, count: int) -> None:
    module = RemnetModule(samples, 16, modules, reduction, seed=1)
    fused = FusedNetwork(module, replace(RECIPE, batch_size=count))
    X, y = rows(count, samples)
    data = Data(X, y, fused.draws(count, np.random.default_rng(3)))
    expected = autograd_gradient(module, data, fused.network.parameters)
    assert np.abs(expected).max() > 1e-3
    assert used(fused, fused.gradient(data)) == pytest.approx(expected, rel=1e-4, abs=2e-6)


def used(fused: FusedNetwork, flat: np.ndarray) -> np.ndarray:
    """Zero what the layout leaves unused (an eighth tap, padding)."""
    copy = RemnetModule(*sizes(fused.module))
    unflatten(flat, copy, fused.layout)
    return flatten(copy, fused.layout)


def test_each_step_is_autograd_and_torch_adam() -> None:
    module = RemnetModule(seed=2)
    fused = FusedNetwork(module, replace(RECIPE, learning_rate=1e-3, weight_decay=0.01))
    weights = torch.nn.Parameter(torch.from_numpy(flatten(module, fused.layout).copy()))
    adam = torch.optim.Adam([weights], 1e-3, weight_decay=0.01)
    for step in range(10):
        X, y = rows(32, 128, seed=step)
        data = Data(X, y, fused.draws(32, np.random.default_rng(step)))
        start = fused.network.parameters.copy()
        expected = autograd_gradient(module, data, start)
        assert used(fused, fused.gradient(data)) == pytest.approx(expected, rel=1e-3, abs=3e-6)
        weights.data.copy_(torch.from_numpy(start))
        weights.grad = torch.from_numpy(fused.network.grads.copy())
        adam.step()
        fused.learn(data)
        assert fused.network.parameters == pytest.approx(weights.detach().numpy(), abs=1e-6)


def test_flatten_and_back_changes_nothing() -> None:
    module, other = RemnetModule(40, modules=2, seed=5), RemnetModule(40, modules=2, seed=6)
    layout = layout_of(module)
    unflatten(flatten(module, layout), other, layout)
    for a, b in zip(module.parameters(), other.parameters(), strict=True):
        assert torch.equal(a, b)


def weights_after(seed: int = 4, count: int = 333) -> torch.Tensor:
    module = RemnetModule(seed=7)
    log = fast_remnet.train(module, *rows(count, 128), replace(RECIPE, seed=seed))
    assert (log.engine, log.epochs, log.rows, log.steps) == ("fused", 2, count, 2 * -(-count // 32))
    return nn.utils.parameters_to_vector(module.parameters()).detach()


def test_weights_depend_on_the_seed_alone() -> None:
    first = weights_after()
    assert torch.equal(first, weights_after())
    assert not torch.equal(first, weights_after(seed=5))


def test_many_networks_end_as_each_alone() -> None:
    lengths, seeds = [333, 64, 200], [4, 9, 2]
    data = [rows(n, 128, seed) for n, seed in zip(lengths, seeds, strict=True)]
    together, alone = ([RemnetModule(seed=s) for s in seeds] for _ in "ab")
    fractions: list[float] = []
    logs = fast_remnet.train_many(
        together, [X for X, _ in data], [y for _, y in data], RECIPE, seeds=seeds,
        progress=fractions.append,
    )  # fmt: skip
    for module, (X, y), seed, log in zip(alone, data, seeds, logs, strict=True):
        expected = fast_remnet.train(module, X, y, replace(RECIPE, seed=seed))
        assert log.epoch_losses == expected.epoch_losses
    for a, b in zip(together, alone, strict=True):
        assert all(torch.equal(p, q) for p, q in zip(a.parameters(), b.parameters(), strict=True))
    assert fractions[-1] == 1.0


def test_learns_what_the_plain_loop_learns() -> None:
    X, y = rows(600, 128)
    recipe = replace(RECIPE, epochs=5, learning_rate=2e-3)
    fused, plain = (
        [
            engine(RemnetModule(seed=s), X, y, replace(recipe, seed=s)).epoch_losses[-1]
            for s in range(2)
        ]
        for engine in (fast_remnet.train, training.train)
    )
    spread = np.std([*fused, *plain])
    assert abs(np.mean(fused) - np.mean(plain)) < max(3 * spread, 0.01)
    assert np.mean(fused) < np.abs(y - np.median(y)).mean()


def test_torch_and_numpy_random_state_stay() -> None:
    torch.manual_seed(0)
    state, numpy_state = torch.get_rng_state(), np.random.get_state()[1].copy()
    weights_after(count=40)
    assert torch.equal(state, torch.get_rng_state())
    assert np.array_equal(numpy_state, np.random.get_state()[1])


def test_progress_rises_to_one_and_may_stop_the_training() -> None:
    fractions: list[float] = []
    X, y = rows(100, 128)
    fast_remnet.train(RemnetModule(), X, y, RECIPE, progress=fractions.append)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0

    def interrupt(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fast_remnet.train(RemnetModule(), X, y, RECIPE, progress=interrupt)


@pytest.mark.parametrize(
    ("module", "change", "part"),
    [
        (nn.Linear(8, 1), {}, "not a REMnet"),
        (RemnetModule(8, 8, 1, 4), {}, "16 features"),
        (RemnetModule(8, 16, 0, 4), {}, "16 features"),
        (RemnetModule(8, 16, 1, 4), {"loss": "mse"}, "'mse'"),
        (RemnetModule(8, 16, 1, 4), {"stopping": Stopping()}, "held out"),
        (RemnetModule(8, 16, 1, 4).double(), {}, "float32"),
    ],
)
def test_says_why_not(module: nn.Module, change: dict[str, object], part: str) -> None:
    reason = fast_remnet.why_not(module, replace(RECIPE, **change))
    assert reason is not None
    assert part in reason


def test_another_width_falls_back_to_the_plain_loop() -> None:
    X, y = rows(70, 20)
    fallen, plain = (RemnetModule(20, 8, 2, 4, seed=3) for _ in "ab")
    log = fast_remnet.train(fallen, X, y, RECIPE)
    training.train(plain, X, y, RECIPE)
    assert log.engine == "eager"
    assert all(
        torch.equal(a, b) for a, b in zip(fallen.parameters(), plain.parameters(), strict=True)
    )


def test_without_numba_it_falls_back() -> None:
    script = """
import sys
sys.modules["numba"] = None
import numpy as np
from zoo.training.fused_remnet import fit as fast_remnet
from zoo.modules.remnet import RemnetModule
module = RemnetModule(8, modules=1)
from zoo.training.recipe import TrainingRecipe
recipe = TrainingRecipe("mae", 1e-3, 2, 1)
assert "numba" in fast_remnet.why_not(module, recipe)
X, y = np.zeros((4, 8), np.float32), np.zeros(4, np.float32)
print(fast_remnet.train(module, X, y, recipe).engine)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.strip() == "eager", done.stderr


@pytest.mark.parametrize(
    ("X", "y", "options", "message"),
    [
        (np.zeros((4, 127)), np.zeros(4), {}, "wants"),
        (np.zeros((4, 128)), np.zeros(3), {}, "do not match"),
        (np.zeros((0, 128)), np.zeros(0), {}, "no rows"),
        (np.zeros((4, 128)), np.zeros(4), {"batch_size": 0}, "positive"),
        (np.zeros((4, 128)), np.zeros(4), {"epochs": 0}, "positive"),
    ],
)
def test_refuses(X: FloatArray, y: FloatArray, options: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fast_remnet.train(RemnetModule(), X, y, replace(RECIPE, **options))


def test_a_nan_shows_in_the_loss() -> None:
    X, y = rows(40, 128)
    X[3, 5] = np.nan
    log = fast_remnet.train(RemnetModule(), X, y, RECIPE)
    assert np.isnan(log.epoch_losses).all()
