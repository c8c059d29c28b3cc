"""Train several networks of one architecture at once, each as it would have been alone.

Small networks spend a step on overhead, not arithmetic. Stacked, one set of calls steps them
all; a REMnet goes to the fused kernels instead, one network per thread.
"""

from __future__ import annotations

import copy
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn

from zoo.modules.remnet import RemnetModule
from zoo.training.eager import (
    FloatArray,
    Progress,
    as_tensors,
    epoch_orders,
    report,
    train,
)
from zoo.training.fused_remnet import fit as fused_remnet
from zoo.training.recipe import TrainingLog, TrainingRecipe, check_recipe
from zoo.training.stacked.step import Stack

Arrays = FloatArray | Sequence[FloatArray]
_STEPS_BETWEEN_REPORTS = 100


def train_stacked(
    modules: Sequence[nn.Module],
    X: Arrays,
    y: Arrays,
    recipe: TrainingRecipe,
    *,
    seeds: Sequence[int],
    progress: Progress | None = None,
) -> list[TrainingLog]:
    """Train `modules` in place with Adam, network m with seeds[m], and leave them in eval mode.

    X is one array [n, ...] for all, or a sequence with one per network, of any lengths; y
    likewise. Each network gets the shuffling and dropout that `eager.train` (a REMnet:
    `fused_remnet.train`) would give it with its seed, and ends with the same weights within
    rounding. `loss` must be a mean over rows. Modules that cannot be stacked (see `why_not`)
    are trained one after the other, as is a recipe with `stopping` or `decay`.
    The recipe's own seed is not used. Logs of stacked networks share the wall time.
    Raises ValueError on unequal numbers of modules, arrays and seeds, or bad data.
    """
    inputs, targets = (_per_network(array, len(modules)) for array in (X, y))
    if len(seeds) != len(modules):
        raise ValueError(f"{len(modules)} modules but {len(seeds)} seeds")
    for a, b in zip(inputs, targets, strict=True):
        check_recipe(recipe, len(as_tensors(a, b)[0]))
    if modules and all(fused_remnet.why_not(module, recipe) is None for module in modules):
        remnets = [module for module in modules if isinstance(module, RemnetModule)]
        return fused_remnet.train_many(
            remnets, inputs, targets, recipe, seeds=seeds, progress=progress
        )
    if recipe.stopping is not None or recipe.decay or why_not(modules, inputs) is not None:
        return _train_in_turn(modules, inputs, targets, seeds, recipe, progress)
    return _train_stack(modules, inputs, targets, seeds, recipe, progress)


def why_not(modules: Sequence[nn.Module], X: Sequence[FloatArray]) -> str | None:
    """Return why `modules` cannot be stacked, or None. X holds the inputs of each."""
    if len(modules) < 2:
        return "there is nothing to stack"
    if len({_architecture(module, x) for module, x in zip(modules, X, strict=True)}) > 1:
        return "the architectures differ"
    if any(not p.requires_grad or p.dtype != torch.float32 for p in modules[0].parameters()):
        return "a parameter is frozen or not float32"
    for child in modules[0].modules():
        if isinstance(child, nn.modules.dropout._DropoutNd) and type(child) is not nn.Dropout:
            return f"{type(child).__name__} has no stacked form"
    return _state_that_changes(modules[0], X[0])


def _architecture(module: nn.Module, x: FloatArray) -> str:
    shapes = [(name, tuple(value.shape)) for name, value in module.state_dict().items()]
    return f"{module} {shapes} {x.shape[1:]}"


def _state_that_changes(module: nn.Module, x: FloatArray) -> str | None:
    """Batch norms and observers learn in the forward pass; a stack would lose that."""
    trial = copy.deepcopy(module).train()
    with torch.no_grad(), torch.random.fork_rng(devices=[]):
        trial(torch.from_numpy(np.ascontiguousarray(x[:2], dtype=np.float32)))
    before = dict(module.named_buffers())
    for name, after in trial.named_buffers():
        if not torch.equal(before[name], after):
            return f"buffer {name} changes during training"
    return None


def _per_network(array: Arrays, count: int) -> list[FloatArray]:
    if isinstance(array, np.ndarray):
        return [array] * count
    if len(array) != count:
        raise ValueError(f"{count} modules but {len(array)} arrays")
    return list(array)


def _train_in_turn(
    modules: Sequence[nn.Module],
    X: list[FloatArray],
    y: list[FloatArray],
    seeds: Sequence[int],
    recipe: TrainingRecipe,
    progress: Progress | None,
) -> list[TrainingLog]:
    logs = []
    for i, (module, a, b, seed) in enumerate(zip(modules, X, y, seeds, strict=True)):
        logs.append(train(module, a, b, replace(recipe, seed=seed)))
        report(progress, (i + 1) / len(modules))
    return logs


class _Schedule:
    """Which rows one network trains on at each step."""

    def __init__(self, first: int, rows: int, recipe: TrainingRecipe, seed: int) -> None:
        self._first, self._batch_size, self.rows = first, recipe.batch_size, rows
        self.steps_per_epoch = -(-rows // recipe.batch_size)
        self.steps = self.steps_per_epoch * recipe.epochs
        self._orders = epoch_orders(rows, recipe.epochs, seed)

    def batch(self, step: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        """Rows of the pooled data for `step`, to be asked in order; none after the last."""
        if step >= self.steps:
            return np.empty(0, np.int64)
        place = step % self.steps_per_epoch
        if place == 0:
            self._order = next(self._orders) + self._first
        return self._order[place * self._batch_size : (place + 1) * self._batch_size]


class _Pool(NamedTuple):
    """The rows of all networks in one tensor, and where each network's begin."""

    inputs: Tensor
    targets: Tensor
    starts: list[int]


def _pooled(X: list[FloatArray], y: list[FloatArray]) -> _Pool:
    """Pool the data; a pair of arrays that several networks share comes in once."""
    pairs = {(id(a), id(b)): (a, b) for a, b in zip(X, y, strict=True)}
    starts = np.cumsum([0, *(len(b) for _, b in pairs.values())])
    where = dict(zip(pairs, starts.tolist(), strict=False))
    tensors = [as_tensors(a, b) for a, b in pairs.values()]
    inputs, targets = (torch.cat(parts) for parts in zip(*tensors, strict=True))
    return _Pool(inputs, targets, [where[id(a), id(b)] for a, b in zip(X, y, strict=True)])


def _train_stack(
    modules: Sequence[nn.Module],
    X: list[FloatArray],
    y: list[FloatArray],
    seeds: Sequence[int],
    recipe: TrainingRecipe,
    progress: Progress | None,
) -> list[TrainingLog]:
    started = time.perf_counter()
    pool = _pooled(X, y)
    schedules = [
        _Schedule(start, len(errors), recipe, seed)
        for start, errors, seed in zip(pool.starts, y, seeds, strict=True)
    ]
    losses = _run(modules, pool, schedules, seeds, recipe, progress)
    seconds = time.perf_counter() - started
    return [
        TrainingLog(
            _epoch_losses(losses[:, m], schedule), schedule.rows, seconds, "stacked", schedule.steps
        )
        for m, schedule in enumerate(schedules)
    ]


def _run(
    modules: Sequence[nn.Module],
    pool: _Pool,
    schedules: Sequence[_Schedule],
    seeds: Sequence[int],
    recipe: TrainingRecipe,
    progress: Progress | None,
) -> Tensor:
    """Take every step; return the summed losses [steps, networks]."""
    stack = Stack(modules, pool.inputs[:1], recipe.loss, seeds, recipe.batch_size)
    steps = max(schedule.steps for schedule in schedules)
    together = all(schedule.steps == steps for schedule in schedules)
    optimiser = stack.adam(recipe.learning_rate, recipe.weight_decay, together)
    losses = torch.zeros(steps, len(modules))
    for step in range(steps):
        batches = [schedule.batch(step) for schedule in schedules]
        losses[step] = stack.step(pool.inputs, pool.targets, batches, optimiser)
        if (step + 1) % _STEPS_BETWEEN_REPORTS == 0 or step + 1 == steps:
            report(progress, (step + 1) / steps)
    stack.write_back()
    return losses


def _epoch_losses(losses: Tensor, schedule: _Schedule) -> tuple[float, ...]:
    per_step = losses[: schedule.steps].double().view(-1, schedule.steps_per_epoch)
    return tuple((per_step.sum(dim=1) / schedule.rows).tolist())
