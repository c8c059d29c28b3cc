"""Training by steps, with an end decided on links that were held out."""

from __future__ import annotations

import time
from collections.abc import Iterator
from copy import deepcopy
from itertools import islice

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor, nn

from zoo.training.averaging import RunningMean
from zoo.training.eager import (
    FloatArray,
    Loop,
    Progress,
    as_tensors,
    loss_function,
    one_thread,
    report,
)
from zoo.training.recipe import Stopping, TrainingLog, TrainingRecipe, check_recipe

_BLOCK_ROWS = 4096


def train_until(
    module: nn.Module,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    stopping: Stopping,
    groups: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train `module` in place until held-out links say stop, and keep the best weights.

    Judged and kept is the running mean of the weights.
    Without `groups` rows are held out singly. Where nothing can be held out (fewer than two
    groups), `most_steps` are taken. Raises ValueError as `zoo.training.eager.train`.
    """
    inputs, targets = as_tensors(X, y)
    check_recipe(recipe, len(inputs))
    started, links = time.perf_counter(), link_numbers(groups, len(inputs))
    held = held_out(links, stopping.share, recipe.seed)
    learn = torch.from_numpy(np.flatnonzero(~held))
    judge = _Judge(module, recipe, inputs[held], targets[held], links[held])
    loop = Loop(module, recipe, len(learn))
    with torch.random.fork_rng(devices=[]), one_thread():
        torch.manual_seed(recipe.seed)
        batches = _batches(inputs[learn], targets[learn], recipe)
        losses = _run(module, loop, batches, judge, stopping, recipe.batch_size, progress)
    judge.restore()
    seconds = time.perf_counter() - started
    looks = tuple(judge.losses)
    seen = min(loop.steps * recipe.batch_size, loop.steps * len(learn))
    return TrainingLog(tuple(losses), len(learn), seconds, "eager", loop.steps, looks, seen)


def held_out(links: NDArray[np.int64], share: float, seed: int) -> NDArray[np.bool_]:
    """Mark the rows [n] of a `share` of the links (at least one), none of fewer than two links."""
    names = np.unique(links)
    if len(names) < 2:
        return np.zeros(len(links), np.bool_)
    count = min(max(1, round(share * len(names))), len(names) - 1)
    chosen = np.random.default_rng([seed, 1]).permutation(names)[:count]
    return np.isin(links, chosen)


def link_numbers(groups: ArrayLike | None, rows: int) -> NDArray[np.int64]:
    """Return the links of rows numbered from 0 [rows]; without `groups` each row is its own.

    Raises ValueError where there are not as many groups as rows.
    """
    if groups is None:
        return np.arange(rows)
    labels = np.unique(np.asarray(groups), return_inverse=True)[1].astype(np.int64)
    if len(labels) != rows:
        raise ValueError(f"{len(labels)} groups for {rows} rows")
    return labels


def _batches(
    inputs: Tensor, targets: Tensor, recipe: TrainingRecipe
) -> Iterator[tuple[Tensor, Tensor]]:
    generator = np.random.default_rng(recipe.seed)
    while True:
        order = torch.from_numpy(generator.permutation(len(inputs)))
        for rows in torch.split(order, recipe.batch_size):
            yield inputs[rows], targets[rows]


def _run(
    module: nn.Module,
    loop: Loop,
    batches: Iterator[tuple[Tensor, Tensor]],
    judge: _Judge,
    stopping: Stopping,
    batch_size: int,
    progress: Progress | None,
) -> list[float]:
    losses, mean = [], RunningMean(module)
    while loop.steps < stopping.most_steps and judge.waited < stopping.patience:
        module.train()
        steps = min(stopping.every, stopping.most_steps - loop.steps)
        losses.append(loop.run(islice(batches, steps), mean.take) / (steps * batch_size))
        module.eval()
        with mean.worn():
            judge.look()
        report(progress, loop.steps / stopping.most_steps)
    report(progress, 1.0)
    return losses


class _Judge:
    """Takes the loss on the rows held out, and remembers the best weights."""

    def __init__(
        self,
        module: nn.Module,
        recipe: TrainingRecipe,
        inputs: Tensor,
        targets: Tensor,
        links: NDArray[np.int64],
    ) -> None:
        self._module, self._criterion = module, loss_function(recipe.loss)
        self._inputs, self._targets = inputs, targets
        self._links = [torch.from_numpy(np.flatnonzero(links == k)) for k in np.unique(links)]
        self.losses: list[float] = []
        self.waited = 0
        self._best: dict[str, Tensor] | None = None

    def look(self) -> None:
        """Take the loss, each link counting alike; where nothing is held out the last is best."""
        if not len(self._inputs):
            self._best = deepcopy(self._module.state_dict())
            return
        with torch.no_grad():
            blocks = [self._module(block) for block in torch.split(self._inputs, _BLOCK_ROWS)]
            predicted = torch.cat(blocks)
            per_link = [self._criterion(predicted[k], self._targets[k]) for k in self._links]
        loss = float(torch.stack(per_link).mean())
        if not self.losses or loss < min(self.losses):
            self._best, self.waited = deepcopy(self._module.state_dict()), 0
        else:
            self.waited += 1
        self.losses.append(loss)

    def restore(self) -> None:
        """Put the best weights back."""
        if self._best is not None:
            self._module.load_state_dict(self._best)
