"""Training steps of REMnet inside numba: gradients over the batch, then Adam.

A batch is cut into PARTS, each with its own gradient sums, which are then added in order: fewer
roundings follow one another than in one long sum.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from zoo.training.fused_remnet.layers import backward, forward, transpose_weights
from zoo.training.fused_remnet.vector import address, inlined, kernel, put, shift

PARTS = 8
BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-8
_ZERO = np.float32(0)


class Network(NamedTuple):
    """One network in training: its offsets, weights, Adam's moments and the scratch arrays.

    `net`, `blocks`: see Layout. `parameters`, `mean`, `square`: [parameters]. `back`:
    [transposed]. `grads` of a batch and `part` of it: [parameters]. `work`: [work].
    """

    net: Any
    blocks: Any
    parameters: Any
    mean: Any
    square: Any
    back: Any
    grads: Any
    part: Any
    work: Any


class Data(NamedTuple):
    """Rows in training order.

    `signals` [n, samples], `errors` in metres [n], and `draws` [n, final * 16]: uint16, uniform,
    for the dropout.
    """

    signals: Any
    errors: Any
    draws: Any


class Settings(NamedTuple):
    """Batch rows; dropout (a draw below `drop_below` drops, the rest times `keep_scale`); Adam."""

    batch_size: int
    drop_below: int
    keep_scale: Any
    learning_rate: float
    weight_decay: float


@inlined
def _set_mask(work: Any, start: int, data: Data, row: int, settings: Settings) -> None:
    draws = data.draws[row]
    for i in range(len(draws)):
        kept = draws[i] >= settings.drop_below
        put(work, start + i, settings.keep_scale if kept else _ZERO)


@kernel
def _row_gradient(
    network: Network, work: Any, grads: Any, data: Data, row: int, settings: Settings, share: Any
) -> Any:
    """Add the gradient of one row's absolute error times `share`; return that error."""
    net, blocks, weights = network.net[0], network.blocks, address(network.parameters)
    _set_mask(work, net.mask, data, row, settings)
    signal = shift(address(data.signals), row * net.samples)
    difference = forward(net, blocks, weights, signal, work) - data.errors[row]
    slope = share * np.float32(np.sign(difference))
    backward(net, blocks, weights, address(network.back), work, grads, slope)
    return abs(difference)


@inlined
def _part_gradient(
    network: Network, part: int, data: Data, first: int, last: int, settings: Settings
) -> Any:
    """Leave in network.part the gradient of one part of rows first..last; return their error."""
    grads, work, count = address(network.part), address(network.work), last - first
    for i in range(len(network.part)):
        put(grads, i, _ZERO)
    total, share = 0.0, np.float32(1.0 / count)
    for row in range(first + part * count // PARTS, first + (part + 1) * count // PARTS):
        total += _row_gradient(network, work, grads, data, row, settings, share)
    return total


@kernel
def _batch_gradient(network: Network, data: Data, first: int, settings: Settings) -> Any:
    """Leave the batch's gradient in network.grads; return its summed absolute error."""
    last, total = min(first + settings.batch_size, len(data.errors)), 0.0
    network.grads[:] = _ZERO
    for part in range(PARTS):
        total += _part_gradient(network, part, data, first, last, settings)
        for i in range(len(network.grads)):
            network.grads[i] += network.part[i]
    return total


@kernel
def _adam(network: Network, step: int, settings: Settings) -> None:
    """Kingma & Ba 2015, algorithm 1, ordered as in torch.optim.Adam."""
    mean, square, weights = network.mean, network.square, network.parameters
    grads, decay = network.grads, np.float32(settings.weight_decay)
    rate = np.float32(settings.learning_rate / (1.0 - BETA_1**step))
    root = np.float32(1.0 / math.sqrt(1.0 - BETA_2**step))
    new_mean, new_square = np.float32(1.0 - BETA_1), np.float32(1.0 - BETA_2)
    old_square, epsilon = np.float32(BETA_2), np.float32(EPSILON)
    for i in range(len(weights)):
        grad = grads[i] + decay * weights[i]
        mean[i] += new_mean * (grad - mean[i])
        square[i] = old_square * square[i] + new_square * grad * grad
        weights[i] -= rate * mean[i] / (math.sqrt(square[i]) * root + epsilon)


@inlined
def lead(network: Network, data: Data, settings: Settings, done: int, learn: bool) -> float:
    """Go once over `data` in order, `done` steps in; return the summed absolute error.

    Without `learn` the weights stay, and the last batch's gradient is left in network.grads.
    """
    total = 0.0
    for first in range(0, len(data.errors), settings.batch_size):
        transpose_weights(network.blocks, address(network.parameters), address(network.back))
        total += _batch_gradient(network, data, first, settings)
        done += 1
        if learn:
            _adam(network, done, settings)
    return total
