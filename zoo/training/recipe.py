"""The one type of training settings, and what a training leaves to be read."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from torch import Tensor

    LossFunction = Callable[[Tensor, Tensor], Tensor]

Engine = Literal["eager", "fused", "stacked"]


@dataclass(frozen=True)
class Stopping:
    """Training by steps, ended when the loss on held-out links has stopped falling.

    `share` of the links are held out; every `every` steps the weights' running mean is judged by
    the mean loss over their rows, each link counting alike; training ends after `patience` such
    looks without a better one, or after `most_steps` steps, and the best mean is kept.
    """

    most_steps: int = 6000
    every: int = 100
    patience: int = 10
    share: float = 0.2


@dataclass(frozen=True)
class TrainingRecipe:
    """How a gradient-trained model is trained; every engine takes this and nothing else.

    `loss`: "mae" or "mse" (metres, metres squared), or a function of predictions and targets that
    is a mean over rows. Adam at a constant `learning_rate`, or one that falls to 0 along a half
    cosine over all epochs (`decay`); `weight_decay` is its L2 penalty.
    `epochs` passes over all rows, unless `stopping` says to train by steps. `seed` drives
    shuffling, dropout and which links are held out.
    """

    loss: Literal["mae", "mse"] | LossFunction
    learning_rate: float
    batch_size: int
    epochs: int
    weight_decay: float = 0.0
    seed: int = 0
    stopping: Stopping | None = None
    decay: bool = False


def falling(learning_rate: float, done: float) -> float:
    """Return a learning rate that falls to 0 along a half cosine, at a share done of the steps."""
    return learning_rate * 0.5 * (1 + math.cos(math.pi * done))


@dataclass(frozen=True)
class TrainingLog:
    """What one training did.

    `epoch_losses`: mean loss of each epoch over its rows, dropout active (metres for "mae"); with
    `Stopping`, that between two looks. `rows`: rows per epoch. `seconds`: wall time.
    `held_out_losses`: the loss at each look, none where nothing was held out. `steps`: batches.
    `rows_seen`: rows trained on in all, where training went by steps.
    """

    epoch_losses: tuple[float, ...]
    rows: int
    seconds: float
    engine: Engine
    steps: int
    held_out_losses: tuple[float, ...] = ()
    rows_seen: int | None = None

    @property
    def epochs(self) -> int:
        """How many passes over the rows there were, rounded where training went by steps."""
        if self.rows_seen is None:
            return len(self.epoch_losses)
        return round(self.rows_seen / self.rows)

    @property
    def rows_per_second(self) -> float:
        """Rows trained on per second, all epochs together."""
        seen = self.rows * len(self.epoch_losses) if self.rows_seen is None else self.rows_seen
        return seen / self.seconds


def check_recipe(recipe: TrainingRecipe, rows: int) -> None:
    """Raise ValueError unless there are rows, sizes are positive, a falling rate's end is known."""
    if rows < 1:
        raise ValueError("no rows to train on")
    if recipe.batch_size < 1 or recipe.epochs < 1:
        sizes = f"batch_size {recipe.batch_size} and epochs {recipe.epochs}"
        raise ValueError(f"{sizes} must be positive")
    if recipe.decay and recipe.stopping is not None:
        raise ValueError("a rate that falls needs to know the last step: no stopping with decay")
