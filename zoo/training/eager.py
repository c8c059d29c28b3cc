"""The plain training loop for any torch model, and what every training engine shares."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

FloatArray = NDArray[np.float32]
Progress = Callable[[float], object]
LossFunction = Callable[[Tensor, Tensor], Tensor]
Loss = Literal["mae", "mse"] | LossFunction

_LOSSES: dict[str, LossFunction] = {
    "mae": nn.functional.l1_loss,
    "mse": nn.functional.mse_loss,
}


@dataclass(frozen=True)
class TrainingLog:
    """What one training did.

    `epoch_losses`: mean loss of each epoch over its rows, dropout active (metres for "mae").
    `rows`: rows per epoch. `seconds`: wall time. `engine`: "eager", "fused" or "stacked".
    """

    epoch_losses: tuple[float, ...]
    rows: int
    seconds: float
    engine: str

    @property
    def rows_per_second(self) -> float:
        """Rows trained on per second, all epochs together."""
        return self.rows * len(self.epoch_losses) / self.seconds


def train(
    module: nn.Module,
    X: FloatArray,
    y: FloatArray,
    *,
    loss: Loss,
    learning_rate: float,
    batch_size: int,
    epochs: int,
    seed: int,
    weight_decay: float = 0.0,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train `module` in place with Adam, and leave it in eval mode.

    X is [n, ...] and y [n]; the module maps a batch of X to [batch]. The last partial batch
    counts. Shuffling and dropout come from `seed`; the global random state is left as it was.
    `progress` is called after every epoch with the fraction done.
    Raises ValueError on empty or mismatched data, or sizes below one.
    """
    inputs, targets = as_tensors(X, y)
    check_protocol(len(inputs), batch_size, epochs)
    optimiser = torch.optim.Adam(
        trainable(module), learning_rate, weight_decay=weight_decay, fused=True
    )
    started, criterion = time.perf_counter(), loss_function(loss)
    losses = []
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        module.train()
        for epoch, order in enumerate(epoch_orders(len(inputs), epochs, seed)):
            rows = torch.from_numpy(order)
            pieces = (torch.split(tensor[rows], batch_size) for tensor in (inputs, targets))
            total = _train_epoch(module, optimiser, criterion, zip(*pieces, strict=True))
            losses.append(total / len(inputs))
            report(progress, (epoch + 1) / epochs)
    module.eval()
    return TrainingLog(tuple(losses), len(inputs), time.perf_counter() - started, "eager")


def _train_epoch(
    module: nn.Module,
    optimiser: torch.optim.Optimizer,
    criterion: LossFunction,
    batches: Iterator[tuple[Tensor, Tensor]],
) -> float:
    total = torch.zeros((), dtype=torch.float64)
    for inputs, targets in batches:
        optimiser.zero_grad()
        error = criterion(module(inputs), targets)
        error.backward()  # type: ignore[no-untyped-call]
        optimiser.step()
        total += error.detach() * len(inputs)  # no .item(): it would cost a call per step
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


def check_protocol(rows: int, batch_size: int, epochs: int) -> None:
    """Raise ValueError unless there are rows, and batch size and epochs are positive."""
    if rows < 1:
        raise ValueError("no rows to train on")
    if batch_size < 1 or epochs < 1:
        raise ValueError(f"batch_size {batch_size} and epochs {epochs} must be positive")


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
