"""The plain training loop."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from zoo.cnn1d import CNN1D
from zoo.training.eager import FloatArray, epoch_orders, train
from zoo.training.recipe import Stopping, TrainingLog, TrainingRecipe
from zoo.training.stopping import held_out

RECIPE = TrainingRecipe("mse", 1e-2, 16, 3, seed=1)


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
    adam = torch.optim.Adam(module.parameters(), RECIPE.learning_rate, weight_decay=decay)
    for order in epoch_orders(len(y), RECIPE.epochs, seed):
        for start in range(0, len(y), RECIPE.batch_size):
            batch = order[start : start + RECIPE.batch_size]
            adam.zero_grad()
            predicted = module(torch.from_numpy(X[batch]))
            nn.functional.mse_loss(predicted, torch.from_numpy(y[batch])).backward()
            adam.step()


@pytest.mark.parametrize("decay", [0.0, 0.1])
def test_takes_the_steps_of_a_tutorial_loop(decay: float) -> None:
    X, y = rows(70)  # the last batch has six rows
    ours, theirs = network(), network()
    train(ours, X, y, replace(RECIPE, seed=5, weight_decay=decay))
    reference(theirs, X, y, seed=5, decay=decay)
    for a, b in zip(ours.parameters(), theirs.parameters(), strict=True):
        assert a.detach().numpy() == pytest.approx(b.detach().numpy(), abs=1e-5)


def test_the_seed_decides_everything() -> None:
    a, b, c = network(0.5), network(0.5), network(0.5)
    X, y = rows(70)
    for module, seed in ((a, 1), (b, 1), (c, 2)):
        torch.manual_seed(int(torch.randint(1000, ())))  # the global state must not matter
        train(module, X, y, replace(RECIPE, loss="mae", seed=seed))
    assert same(a, b)
    assert not same(a, c)


def test_global_random_state_stays() -> None:
    state = torch.get_rng_state()
    train(network(0.5), *rows(20), replace(RECIPE, loss="mae"))
    assert torch.equal(state, torch.get_rng_state())


def test_log_and_progress() -> None:
    fractions: list[float] = []
    module = network()
    log = train(module, *rows(70), RECIPE, progress=fractions.append)
    assert isinstance(log, TrainingLog)
    assert log.engine == "eager"
    assert (log.rows, log.epochs, log.steps) == (70, 3, 15)
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
    train(module, *rows(20), replace(RECIPE, loss=nn.functional.huber_loss))
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
        train(network(), X, y, replace(RECIPE, **change))


def noisy(links: int = 12, per_link: int = 20) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Rows that carry the name of their link: what is learnt by name is wrong on other links."""
    generator = np.random.default_rng(2)
    groups = np.repeat(np.arange(links), per_link)
    X = generator.standard_normal((links * per_link, 6)).astype(np.float32)
    X[:, 1:] = generator.standard_normal((links, 5))[groups]
    offsets = generator.standard_normal(links)[groups]
    return X, (X[:, 0] + offsets).astype(np.float32), groups


def test_training_stops_on_held_out_links_and_keeps_the_best_weights() -> None:
    X, y, groups = noisy()
    stopping = Stopping(most_steps=3000, every=20, patience=4)
    module, recipe = network(), replace(RECIPE, stopping=stopping)
    log = train(module, X, y, recipe, groups=groups)
    assert log.steps < 3000
    assert log.steps == 20 * len(log.held_out_losses)
    best = int(np.argmin(log.held_out_losses))
    assert best == len(log.held_out_losses) - 1 - stopping.patience
    held = held_out(groups, stopping.share, recipe.seed)
    with torch.no_grad():
        residuals = module(torch.from_numpy(X[held])).numpy() - y[held]
    assert (residuals**2).mean() == pytest.approx(log.held_out_losses[best], rel=1e-5)
    assert log.rows == (~held).sum()


def test_no_link_is_on_both_sides_and_one_link_is_trained_to_the_last_step() -> None:
    groups = np.repeat(np.arange(10), 3)
    held = held_out(groups, 0.3, 0)
    assert held.sum() == 9
    assert not set(groups[held]) & set(groups[~held])
    X, y = rows(30)
    recipe = replace(RECIPE, stopping=Stopping(most_steps=25, every=10))
    log = train(network(), X, y, recipe, groups=np.zeros(30))
    assert (log.steps, log.held_out_losses) == (25, ())
    with pytest.raises(ValueError, match="29 groups for 30 rows"):
        train(network(), X, y, recipe, groups=np.zeros(29))


def test_weights_do_not_depend_on_the_number_of_threads() -> None:
    """A convolution's gradient, summed over two threads, had other bits than over one."""
    X = np.random.default_rng(1).rayleigh(100, (512, 157)).astype(np.float32)
    before, fitted = torch.get_num_threads(), []
    try:
        for threads in (1, 2):
            torch.set_num_threads(threads)
            fitted.append(CNN1D(epochs=1, random_state=0).fit(X, X[:, 6] / 1000).predict(X))
            assert torch.get_num_threads() == threads
    finally:
        torch.set_num_threads(before)
    np.testing.assert_array_equal(*fitted)
