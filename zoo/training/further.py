"""Training an average of networks further as one, where many links say that it helps."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from zoo.training.recipe import Stopping, TrainingLog, TrainingRecipe
from zoo.training.stopping import held_out, train_until

FEWEST_LINKS = 150
"""A fifth of fewer links is too few to tell a gain from chance."""

_PASSES, _BATCH_ROWS = 12, 128
_LOOK_EVERY, _PATIENCE = 250, 4
_SHARE, _BEYOND = 0.2, 2.0  # of the links are held out; standard errors that a gain must exceed


def train_further(
    network: nn.Module,
    inputs: Tensor,
    targets: Tensor,
    recipe: TrainingRecipe,
    links: NDArray[np.int64],
) -> TrainingLog:
    """Train rows [n, ...] -> errors [n] in metres further in place, or leave the network as it is.

    At most 12 passes over the rows, so that steps grow with them, without blur or decay: these are
    for few links. It is left as it is with fewer than `FEWEST_LINKS` `links` [n], and where the
    mean gain of the links held out is not above two of its standard errors.
    """
    if len(np.unique(links)) < FEWEST_LINKS:
        return TrainingLog((), len(inputs), 0.0, "eager", 0)
    held = held_out(links, _SHARE, recipe.seed)
    start, before = deepcopy(network.state_dict()), _per_link(network, inputs, targets, links, held)
    stopping = Stopping(_PASSES * len(inputs) // _BATCH_ROWS, _LOOK_EVERY, _PATIENCE, _SHARE)
    as_one = replace(recipe, batch_size=_BATCH_ROWS, weight_decay=0.0, stopping=stopping)
    log = train_until(network, inputs.numpy(), targets.numpy(), as_one, stopping, links)
    gain = before - _per_link(network, inputs, targets, links, held)
    if gain.mean() <= _BEYOND * gain.std() / np.sqrt(len(gain)):
        network.load_state_dict(start)
    return log


def _per_link(
    network: nn.Module,
    inputs: Tensor,
    targets: Tensor,
    links: NDArray[np.int64],
    chosen: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Return the mean |residual| of each link of the chosen rows, in metres."""
    with torch.no_grad():
        left_m = (network.eval()(inputs[chosen]) - targets[chosen]).abs().numpy()
    numbers = np.unique(links[chosen], return_inverse=True)[1]
    means: NDArray[np.float64] = np.bincount(numbers, left_m) / np.bincount(numbers)
    return means
