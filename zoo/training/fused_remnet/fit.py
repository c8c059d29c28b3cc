"""REMnet training with fused kernels: the same steps as `eager.train`, many times faster.

A step of this network is some 300 small tensor operations in eager torch, almost all of it
overhead. Here numba compiles one function that does whole epochs: per sample, forward and
backward stay in cache; per batch, gradients are added up; then Adam.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import replace
from functools import partial
from threading import Event
from typing import TYPE_CHECKING

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import nn

from zoo.modules.remnet import RemnetModule
from zoo.training import eager
from zoo.training.eager import FloatArray, Progress, as_tensors, epoch_orders, report
from zoo.training.recipe import TrainingLog, TrainingRecipe, check_recipe

if TYPE_CHECKING:
    from zoo.training.fused_remnet.network import FusedNetwork
    from zoo.training.fused_remnet.steps import Data

_STEPS_PER_CALL = 64  # between calls Ctrl-C works; 64 steps last some 50 ms
_SECONDS_BETWEEN_REPORTS = 0.2


def why_not(module: nn.Module, recipe: TrainingRecipe) -> str | None:
    """Return why the fused kernels cannot train `module` by `recipe`, or None if they can."""
    if type(module) is not RemnetModule:
        return "not a REMnet"
    if module.features != 16 or len(module.rrms) == 0 or module.reduction > 16:
        return f"the kernels need 16 features and a module, not {module.features}"
    if recipe.loss != "mae":
        return f"the kernels know the loss 'mae', not {recipe.loss!r}"
    if recipe.stopping is not None or recipe.decay:
        return "the kernels train whole epochs at a constant rate, and none is held out"
    if any(not p.requires_grad or p.dtype != torch.float32 for p in module.parameters()):
        return "a parameter is frozen or not float32"
    try:
        importlib.import_module("zoo.training.fused_remnet.network")
    except ImportError as error:
        return f"numba is not available: {error}"
    return None


def train(
    module: nn.Module,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    *,
    groups: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train as `zoo.training.eager.train` does, fused if `why_not` has no objection.

    X is [n, samples] and y [n] in metres. The weights depend on the seed and the machine's
    instruction set. Dropout masks differ from the plain loop's, so the two agree as two seeds
    do. Raises ValueError as the plain loop.
    """
    if why_not(module, recipe) is not None:
        return eager.train(module, X, y, recipe, groups=groups, progress=progress)
    assert isinstance(module, RemnetModule)
    return _train(module, *_checked(module, X, y, recipe), recipe, partial(report, progress))


def train_many(
    modules: Sequence[RemnetModule],
    X: Sequence[FloatArray],
    y: Sequence[FloatArray],
    recipe: TrainingRecipe,
    *,
    seeds: Sequence[int],
    progress: Progress | None = None,
    threads: int | None = None,
) -> list[TrainingLog]:
    """Train each module on its own X, y and seed, one network per thread, loss "mae".

    Every network ends bit for bit as `train` would have left it with that seed in the recipe.
    All must pass `why_not`. `threads`: torch's number where not given.
    """
    data = [_checked(m, a, b, recipe) for m, a, b in zip(modules, X, y, strict=True)]
    recipes = [replace(recipe, seed=seed) for seed in seeds]
    with ThreadPoolExecutor(threads or torch.get_num_threads()) as pool:
        watch = _Watch(len(modules))
        jobs = [
            pool.submit(_train, module, *rows, one, partial(watch.note, i))
            for i, (module, rows, one) in enumerate(zip(modules, data, recipes, strict=True))
        ]
        watch.until_done(jobs, progress)
    return [job.result() for job in jobs]


class _Watch:
    """The progress of several trainings in threads, reported by the caller's own thread."""

    def __init__(self, count: int) -> None:
        self._done, self._stop = [0.0] * count, Event()

    def note(self, number: int, done: float) -> None:
        """Take note of training `number`; raise to end it once the caller has given up."""
        if self._stop.is_set():
            raise InterruptedError("training was given up")
        self._done[number] = done

    def until_done(self, jobs: Sequence[Future[TrainingLog]], progress: Progress | None) -> None:
        try:
            pending = set(jobs)
            while pending:
                finished, pending = wait(pending, timeout=_SECONDS_BETWEEN_REPORTS)
                for job in finished:
                    job.result()
                report(progress, sum(self._done) / len(self._done))
        finally:
            self._stop.set()  # Ctrl-C, or one of them failed


def _train(
    module: RemnetModule, X: FloatArray, y: FloatArray, recipe: TrainingRecipe, tell: Progress
) -> TrainingLog:
    from zoo.training.fused_remnet.network import FusedNetwork  # numba loads only when it is used

    started, losses, network = time.perf_counter(), [], FusedNetwork(module, recipe)
    for chunk, data in enumerate(_chunks(network, X, y, recipe)):
        losses.append(network.learn(data))
        tell((chunk + 1) / (recipe.epochs * _chunks_per_epoch(len(y), recipe)))
    network.write_back()
    module.eval()
    per_epoch = np.reshape(losses, (recipe.epochs, -1)).sum(axis=1) / len(y)
    seconds = time.perf_counter() - started
    return TrainingLog(tuple(per_epoch.tolist()), len(y), seconds, "fused", network.steps)


def _chunks(
    network: FusedNetwork, X: FloatArray, y: FloatArray, recipe: TrainingRecipe
) -> Iterator[Data]:
    """Yield all epochs' rows in order, a limited number of whole batches at a time."""
    from zoo.training.fused_remnet.steps import Data

    dropout, size = _dropout_stream(recipe.seed), recipe.batch_size * _STEPS_PER_CALL
    for order in epoch_orders(len(y), recipe.epochs, recipe.seed):
        for start in range(0, len(order), size):
            rows = order[start : start + size]
            yield Data(X[rows], y[rows], network.draws(len(rows), dropout))


def _chunks_per_epoch(rows: int, recipe: TrainingRecipe) -> int:
    return -(-rows // (recipe.batch_size * _STEPS_PER_CALL))


def _dropout_stream(seed: int) -> np.random.Generator:
    """Independent of the shuffling, which takes the seed itself."""
    return np.random.Generator(np.random.SFC64(np.random.SeedSequence(seed).spawn(1)[0]))


def _checked(
    module: RemnetModule, X: FloatArray, y: FloatArray, recipe: TrainingRecipe
) -> tuple[FloatArray, FloatArray]:
    """Return contiguous float32 data that the kernels can read without looking."""
    inputs, targets = as_tensors(X, y)
    check_recipe(recipe, len(inputs))
    if inputs.ndim != 2 or inputs.shape[1] != module.samples:
        raise ValueError(f"X is {tuple(inputs.shape)}, the network wants [n, {module.samples}]")
    return inputs.numpy(), targets.numpy()
