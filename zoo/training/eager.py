"""The plain training loop for any torch model, and what every training engine shares."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Literal

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor, nn

from zoo.training.layout import channels_innermost
from zoo.training.recipe import TrainingLog, TrainingRecipe, check_recipe, falling

FloatArray = NDArray[np.float32]
Progress = Callable[[float], object]
LossFunction = Callable[[Tensor, Tensor], Tensor]
Loss = Literal["mae", "mse"] | LossFunction

_LOSSES: dict[str, LossFunction] = {
    "mae": nn.functional.l1_loss,
    "mse": nn.functional.mse_loss,
}


def train(
    module: nn.Module,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    *,
    groups: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train `module` in place with Adam, and leave it in eval mode.

    X is [n, ...] and y [n]; the module maps a batch of X to predictions. The last partial batch
    counts. Shuffling and dropout come from the recipe's seed; the global random state is left as
    it was. `groups` [n], links, is what a recipe with `stopping` holds out by. `progress` is
    called after every epoch with the fraction done.
    Raises ValueError on empty or mismatched data, or sizes below one.
    """
    from zoo.training.stopping import train_until

    if recipe.stopping is not None:
        return train_until(module, X, y, recipe, recipe.stopping, groups, progress)
    inputs, targets = as_tensors(X, y)
    check_recipe(recipe, len(inputs))
    loop, losses, started = Loop(module, recipe, len(inputs)), [], time.perf_counter()
    with torch.random.fork_rng(devices=[]), one_thread():
        torch.manual_seed(recipe.seed)
        module.train()
        for epoch, order in enumerate(epoch_orders(len(inputs), recipe.epochs, recipe.seed)):
            rows = torch.from_numpy(order)
            pieces = (torch.split(data[rows], recipe.batch_size) for data in (inputs, targets))
            losses.append(loop.run(zip(*pieces, strict=True)) / len(inputs))
            report(progress, (epoch + 1) / recipe.epochs)
    module.eval()
    seconds = time.perf_counter() - started
    return TrainingLog(tuple(losses), len(inputs), seconds, "eager", loop.steps)


@contextmanager
def one_thread() -> Iterator[None]:
    """Have torch work in one thread: gradients are summed in the same order on any machine.

    A convolution's weight gradient is summed per thread, so two threads give other bits than one;
    and for networks this small threads wait for each other longer than they work.
    """
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


class Loop:
    """Adam on one module; counts its steps."""

    def __init__(self, module: nn.Module, recipe: TrainingRecipe, rows: int) -> None:
        self._module, self._criterion, self.steps = module, loss_function(recipe.loss), 0
        self._layout = channels_innermost(module, recipe.batch_size)
        self._recipe, self._most = recipe, recipe.epochs * -(-rows // recipe.batch_size)
        self._optimiser = torch.optim.Adam(
            trainable(module), recipe.learning_rate, weight_decay=recipe.weight_decay, fused=True
        )

    def _rate(self) -> float:
        """Return the learning rate of the next step."""
        if not self._recipe.decay:
            return self._recipe.learning_rate
        return falling(self._recipe.learning_rate, self.steps / self._most)

    def run(
        self,
        batches: Iterable[tuple[Tensor, Tensor]],
        after: Callable[[], object] = lambda: None,
    ) -> float:
        """Take a step per batch of inputs and targets; return the loss summed over the rows.

        `after` is called after every step.
        """
        total = torch.zeros((), dtype=torch.float64)
        for inputs, targets in batches:
            self._optimiser.zero_grad()
            self._optimiser.param_groups[0]["lr"] = self._rate()
            with self._layout:
                predicted = self._module(inputs)
            error = self._criterion(predicted, targets)
            error.backward()  # type: ignore[no-untyped-call]
            self._optimiser.step()
            total += error.detach() * len(inputs)  # no .item(): it would cost a call per step
            self.steps += 1
            after()
        return float(total)


def epoch_orders(rows: int, epochs: int, seed: int) -> Iterator[NDArray[np.int64]]:
    """Yield one shuffled row order [rows] per epoch; every engine trains in this order."""
    generator = np.random.default_rng(seed)
    for _ in range(epochs):
        yield generator.permutation(rows)


def as_tensors(X: FloatArray, y: FloatArray) -> tuple[Tensor, Tensor]:
    """Return X [n, ...] and y [n] as float32 tensors; ValueError if they do not fit."""
    inputs = torch.from_numpy(np.ascontiguousarray(X, dtype=np.float32))
    targets = torch.from_numpy(np.ascontiguousarray(y, dtype=np.float32))
    if targets.ndim != 1 or inputs.ndim < 1 or len(inputs) != len(targets):
        raise ValueError(f"X {tuple(inputs.shape)} and y {tuple(targets.shape)} do not match")
    return inputs, targets


def trainable(module: nn.Module) -> list[nn.Parameter]:
    """Return the parameters that learn."""
    return [parameter for parameter in module.parameters() if parameter.requires_grad]


def loss_function(loss: Loss) -> LossFunction:
    """Return the batch-mean loss called `loss`; ValueError if there is none."""
    if callable(loss):
        return loss
    if loss not in _LOSSES:
        raise ValueError(f"unknown loss {loss!r}; known: {', '.join(_LOSSES)}")
    return _LOSSES[loss]


def report(progress: Progress | None, done: float) -> None:
    """Tell `progress`, if there is one, the fraction done."""
    if progress is not None:
        progress(done)
