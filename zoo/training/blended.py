"""Training two networks apart, and what share of the answer each is worth on unseen links."""

from __future__ import annotations

import time
from copy import deepcopy
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import nn

from zoo.modules.blended import BlendedNetwork
from zoo.training import by_hand
from zoo.training.bagged import Bagging, link_bags, train_bagged
from zoo.training.eager import FloatArray, Progress, report
from zoo.training.recipe import TrainingLog, TrainingRecipe
from zoo.training.stopping import link_numbers
from zoo.training.teacher import taught

_BLOCK_ROWS = 4096
_SHARES = np.linspace(0.0, 1.0, 21)


def train_blended(
    network: BlendedNetwork,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    bagging: Bagging,
    said_m: FloatArray | None = None,
    *,
    groups: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train both parts in place and give each its share of the answer.

    The convolutional part learns halfway between the errors [n] and a teacher's word `said_m` [n],
    where there is one. Its share is the one that suits links best which were not trained on: each
    half of the links is judged by what the other half taught, the teacher left out. Without
    `groups` every row is a link. Raises ValueError as `zoo.training.eager.train`.
    """
    started, links = time.perf_counter(), link_numbers(groups, len(y))
    share = _share(network, X, y, recipe, bagging, links, progress)
    lesson = y if said_m is None else taught(y, said_m)
    log = _train_both(network, X, y, lesson, recipe, bagging, links, progress)
    network.blend(share)
    network.eval()
    report(progress, 1.0)
    return replace(log, seconds=time.perf_counter() - started)


def _train_both(
    network: BlendedNetwork,
    X: FloatArray,
    y: FloatArray,
    lesson: FloatArray,
    recipe: TrainingRecipe,
    bagging: Bagging,
    links: NDArray[np.int64],
    progress: Progress | None = None,
) -> TrainingLog:
    steady = replace(recipe, decay=False)  # how many steps there will be is not known
    train_bagged(network.perceptrons, X[:, network.bins :], y, steady, bagging, groups=links)
    half = None if progress is None else lambda done: progress(0.5 + 0.5 * done)
    return by_hand.train(network.trunk, X[:, : network.bins], lesson, recipe, progress=half)


def _share(
    network: BlendedNetwork,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    bagging: Bagging,
    links: NDArray[np.int64],
    progress: Progress | None,
) -> float:
    """Return the convolutional part's share with the smallest loss, each link counting alike."""
    half = link_bags(int(links.max()) + 1, 2, recipe.seed)[0][links]
    if half.all():
        return 1.0
    said = np.empty((2, len(y)), np.float32)
    for turn, learn in enumerate((half, ~half)):
        trial = deepcopy(network)
        own = (X[learn], y[learn])
        _train_both(trial, *own, own[1], recipe, bagging, links[learn])
        said[0, ~learn] = _said(trial.trunk, X[~learn, : network.bins])
        said[1, ~learn] = _said(trial.perceptrons, X[~learn, network.bins :])
        report(progress, 0.25 * (turn + 1))
    return best_share(y - said, links)


def best_share(left_m: FloatArray, links: NDArray[np.int64]) -> float:
    """Return the first answer's share with the least mean |residual| of links.

    `left_m` [2, n] are the two answers' residuals in metres, `links` [n] their numbers.
    """
    weight = 1 / np.bincount(links)[links]
    losses = [np.abs(one * left_m[0] + (1 - one) * left_m[1]) @ weight for one in _SHARES]
    return float(_SHARES[int(np.argmin(losses))])


def _said(module: nn.Module, rows: FloatArray) -> FloatArray:
    with torch.no_grad():
        blocks = [module(one) for one in torch.split(torch.from_numpy(rows.copy()), _BLOCK_ROWS)]
    said: FloatArray = torch.cat(blocks).numpy()
    return said
