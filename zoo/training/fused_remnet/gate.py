"""The squeeze-and-excitation gate of one sample, forward and backward, for the fused kernels."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from zoo.training.fused_remnet.products import row_sum, rows
from zoo.training.fused_remnet.vector import (
    LANES,
    add,
    get,
    inlined,
    kernel,
    lane_sum,
    load,
    multiply,
    multiply_add,
    put,
    splat,
    store,
    where_positive,
)

_ONE = np.float32(1)
_ZERO = np.float32(0)


@kernel
def gate_forward(net: Any, block: Any, parameters: Any, work: Any) -> None:
    """Sum = residual * gate(mean over time of residual) + input."""
    share = splat(np.float32(1.0 / block.length))
    store(work, block.mean, splat(_ZERO))
    row_sum(rows(work, block.mean, 0), rows(work, block.residual, LANES), block.length)
    store(work, block.mean, multiply(load(work, block.mean), share))
    _excite(net, block, parameters, work)
    gate = load(work, block.gate)
    for t in range(block.length):
        at = t * LANES
        residual, skip = load(work, block.residual + at), load(work, block.input + at)
        store(work, block.sum + at, multiply_add(residual, gate, skip))


@inlined
def _excite(net: Any, block: Any, parameters: Any, work: Any) -> None:
    """Gate = sigmoid(excite(relu(squeeze(mean))))."""
    mean, logits = load(work, block.mean), load(parameters, block.excite_bias)
    for h in range(net.hidden):
        weights = load(parameters, block.squeeze_weights + h * LANES)
        hidden = get(parameters, block.squeeze_bias + h) + lane_sum(multiply(weights, mean))
        hidden = hidden if hidden > _ZERO else _ZERO * hidden  # keeps a NaN
        put(work, block.hidden + h, hidden)
        outward = load(parameters, block.excite_weights + h * LANES)
        logits = multiply_add(splat(hidden), outward, logits)
    store(work, block.gate, logits)
    for f in range(block.gate, block.gate + LANES):
        put(work, f, _ONE / (_ONE + math.exp(-get(work, f))))


@kernel
def gate_backward(net: Any, block: Any, parameters: Any, work: Any, grads: Any) -> None:
    """Turn d sum (at net.grad) into d residual before its ReLU (at net.residual_grad)."""
    through = splat(_ZERO)
    for t in range(0, block.length * LANES, LANES):
        through = multiply_add(load(work, net.grad + t), load(work, block.residual + t), through)
    store(work, net.gate_grad, through)
    share = splat(np.float32(1.0 / block.length))
    mean_grad = multiply(_excite_backward(net, block, parameters, work, grads), share)
    gate = load(work, block.gate)
    for t in range(0, block.length * LANES, LANES):
        grad = multiply_add(load(work, net.grad + t), gate, mean_grad)
        store(work, net.residual_grad + t, where_positive(load(work, block.residual + t), grad))


@inlined
def _excite_backward(net: Any, block: Any, parameters: Any, work: Any, grads: Any) -> Any:
    """Add the two dense layers' gradients; return the gradient of the mean."""
    for f in range(LANES):
        gate, at = get(work, block.gate + f), net.gate_grad + f
        put(work, at, get(work, at) * gate * (_ONE - gate))
    logits, mean_grad = load(work, net.gate_grad), splat(_ZERO)
    mean = load(work, block.mean)
    _accumulate(grads, block.excite_bias, logits)
    for h in range(net.hidden):
        inward, outward = block.squeeze_weights + h * LANES, block.excite_weights + h * LANES
        hidden, grad = get(work, block.hidden + h), multiply(logits, load(parameters, outward))
        slope = _ZERO if hidden <= _ZERO else lane_sum(grad)
        _accumulate(grads, outward, multiply(splat(hidden), logits))
        _accumulate(grads, inward, multiply(splat(slope), mean))
        at = block.squeeze_bias + h
        put(grads, at, get(grads, at) + slope)
        mean_grad = multiply_add(splat(slope), load(parameters, inward), mean_grad)
    return mean_grad


@inlined
def _accumulate(grads: Any, at: int, value: Any) -> None:
    store(grads, at, add(load(grads, at), value))
