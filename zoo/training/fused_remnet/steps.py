"""Training steps of REMnet inside numba: gradients over the batch, then Adam.

A batch is always cut into SLOTS pieces, each with its own gradient sums, which are then added
in order. So the weights do not depend on how many threads share the pieces, nor on which does
which.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from zoo.training.fused_remnet.layers import backward, forward, transpose_weights
from zoo.training.fused_remnet.team import (
    all_done,
    close,
    closed,
    finish_ticket,
    open_tickets,
    take_ticket,
    wait_a_little,
)
from zoo.training.fused_remnet.vector import address, inlined, kernel, put, shift

SLOTS = 8
LEAD, HELP, GRADIENT = 0, 1, 2  # roles: train, help the one that does, gradients only
BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-8
_ZERO = np.float32(0)


class Network(NamedTuple):
    """One network in training: its offsets, weights, Adam's moments and the scratch arrays.

    `net`, `blocks`: see Layout. `parameters`, `mean`, `square`: [parameters]. `back`:
    [transposed]. `grads`: [SLOTS, parameters]. `work`: [SLOTS, work]. `losses`: [SLOTS].
    `counters`: [COUNTERS], of its team of threads.
    """

    net: Any
    blocks: Any
    parameters: Any
    mean: Any
    square: Any
    back: Any
    grads: Any
    work: Any
    losses: Any
    counters: Any


class Data(NamedTuple):
    """Rows in training order.

    `signals` [n, samples], `errors` in metres [n], and `draws` [n, final * 16]: uint16, uniform,
    for the dropout.
    """

    signals: Any
    errors: Any
    draws: Any


class Recipe(NamedTuple):
    """Batch rows; dropout (a draw below `drop_below` drops, the rest times `keep_scale`); Adam."""

    batch_size: int
    drop_below: int
    keep_scale: Any
    learning_rate: float
    weight_decay: float


@inlined
def _set_mask(work: Any, start: int, data: Data, row: int, recipe: Recipe) -> None:
    draws = data.draws[row]
    for i in range(len(draws)):
        kept = draws[i] >= recipe.drop_below
        put(work, start + i, recipe.keep_scale if kept else _ZERO)


@kernel
def _row_gradient(
    network: Network, work: Any, grads: Any, data: Data, row: int, recipe: Recipe, share: Any
) -> Any:
    """Add the gradient of one row's absolute error times `share`; return that error."""
    net, blocks, weights = network.net[0], network.blocks, address(network.parameters)
    _set_mask(work, net.mask, data, row, recipe)
    signal = shift(address(data.signals), row * net.samples)
    difference = forward(net, blocks, weights, signal, work) - data.errors[row]
    slope = share * np.float32(np.sign(difference))
    backward(net, blocks, weights, address(network.back), work, grads, slope)
    return abs(difference)


@inlined
def _slot_gradient(
    network: Network, slot: int, data: Data, first: int, last: int, recipe: Recipe
) -> None:
    """Gradient of the mean absolute error, over this slot's share of rows first..last."""
    net = network.net[0]
    grads = shift(address(network.grads), slot * net.parameters)
    work = shift(address(network.work), slot * net.work)
    for i in range(net.parameters):
        put(grads, i, _ZERO)
    total, count = 0.0, last - first
    share = np.float32(1.0 / count)
    for row in range(first + slot * count // SLOTS, first + (slot + 1) * count // SLOTS):
        total += _row_gradient(network, work, grads, data, row, recipe, share)
    network.losses[slot] = total


@inlined
def _add_slots(network: Network) -> Any:
    """Add every slot's gradient to slot 0, in order; return the summed absolute error."""
    total = network.losses[0]
    for slot in range(1, SLOTS):
        total += network.losses[slot]
        into, other = network.grads[0], network.grads[slot]
        for i in range(len(into)):
            into[i] += other[i]
    return total


@kernel
def _adam(network: Network, step: int, recipe: Recipe) -> None:
    """Kingma & Ba 2015, algorithm 1, ordered as in torch.optim.Adam."""
    mean, square, weights = network.mean, network.square, network.parameters
    grads, decay = network.grads[0], np.float32(recipe.weight_decay)
    rate = np.float32(recipe.learning_rate / (1.0 - BETA_1**step))
    root = np.float32(1.0 / math.sqrt(1.0 - BETA_2**step))
    new_mean, new_square = np.float32(1.0 - BETA_1), np.float32(1.0 - BETA_2)
    old_square, epsilon = np.float32(BETA_2), np.float32(EPSILON)
    for i in range(len(weights)):
        grad = grads[i] + decay * weights[i]
        mean[i] += new_mean * (grad - mean[i])
        square[i] = old_square * square[i] + new_square * grad * grad
        weights[i] -= rate * mean[i] / (math.sqrt(square[i]) * root + epsilon)


@inlined
def _do_ticket(network: Network, ticket: int, data: Data, recipe: Recipe) -> None:
    step, slot = divmod(ticket, SLOTS)
    first = step * recipe.batch_size
    last = min(first + recipe.batch_size, len(data.errors))
    _slot_gradient(network, slot, data, first, last, recipe)
    finish_ticket(address(network.counters))


@kernel
def _work_until(network: Network, data: Data, recipe: Recipe, role: int) -> None:
    """Do pieces until the batch is done (the leader) or the team is closed (a helper)."""
    counters, spins = address(network.counters), 0
    while not (closed(counters) if role == HELP else all_done(counters)):
        ticket = take_ticket(counters)
        if ticket >= 0:
            _do_ticket(network, ticket, data, recipe)
            spins = 0
        else:
            spins = wait_a_little(spins)


@inlined
def lead(network: Network, data: Data, recipe: Recipe, done: int, role: int) -> float:
    """Go once over `data` in order, `done` steps in; return the summed absolute error.

    With role GRADIENT the weights stay, and the last batch's gradient is left in slot 0.
    """
    total, counters = 0.0, address(network.counters)
    for _ in range(0, len(data.errors), recipe.batch_size):
        transpose_weights(network.blocks, address(network.parameters), address(network.back))
        open_tickets(counters, SLOTS)
        _work_until(network, data, recipe, role)
        total += _add_slots(network)
        done += 1
        if role == LEAD:
            _adam(network, done, recipe)
    close(counters)
    return total


@inlined
def help_out(network: Network, data: Data, recipe: Recipe, role: int) -> None:
    """Do pieces of the leader's batches until it closes."""
    _work_until(network, data, recipe, role)
