"""REMnet forward and backward on one sample, for the fused kernels."""

from __future__ import annotations

from typing import Any

import numpy as np

from zoo.training.fused_remnet.gate import gate_backward, gate_forward
from zoo.training.fused_remnet.layout import FIRST_ROWS
from zoo.training.fused_remnet.products import convolve, convolve_gradient, rows
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

_ZERO = np.float32(0)
_NO_FLOOR = np.float32(-np.inf)
_SAME = 3
# numpy integers: numba would compile the kernels anew for every literal
_TAPS: Any = np.int64(7)
_UNUSED_TAP_TOO: Any = np.int64(FIRST_ROWS)
_ONE: Any = np.int64(LANES)  # values in a window of one time step
_TWO: Any = np.int64(2 * LANES)
_THREE: Any = np.int64(3 * LANES)


@inlined
def forward(net: Any, blocks: Any, parameters: Any, signal: Any, work: Any) -> Any:
    """Return the prediction in metres for `signal` [samples], dropout as in work[net.mask]."""
    for i in range(net.samples):
        put(work, net.signal + _SAME + i, get(signal, i))
    windows = rows(work, net.signal, 1)
    out = rows(work, _first_map(blocks), LANES)
    weights, bias = rows(parameters, net.first_weights, LANES), rows(parameters, net.first_bias, 0)
    convolve(out, windows, weights, _TAPS, bias, splat(_ZERO), net.samples)
    for i in range(len(blocks)):
        _block_forward(net, blocks[i], parameters, work)
    return get(parameters, net.head_bias) + _head(net, _last_map(blocks), parameters, work)


@inlined
def backward(
    net: Any, blocks: Any, parameters: Any, back: Any, work: Any, grads: Any, slope: Any
) -> None:
    """Add to `grads` what the sample last passed forward gives; slope = d loss / d prediction.

    `back` holds the transposed weights.
    """
    _head_backward(net, _last_map(blocks), parameters, work, grads, slope)
    for i in range(len(blocks) - 1, -1, -1):
        _block_backward(net, blocks[i], parameters, back, work, grads)
    _masked(work, _first_map(blocks), net.grad, net.residual_grad, net.samples)
    weights, bias = rows(grads, net.first_weights, LANES), rows(grads, net.first_bias, 0)
    windows, delta = rows(work, net.signal, 1), rows(work, net.residual_grad, LANES)
    convolve_gradient(weights, bias, windows, _UNUSED_TAP_TOO, delta, net.samples)


@inlined
def _first_map(blocks: Any) -> Any:
    """Where the first convolution's output lies."""
    return blocks[0].input


@inlined
def _last_map(blocks: Any) -> Any:
    """Where the features lie that the head reads."""
    return blocks[len(blocks) - 1].output


@inlined
def _block_forward(net: Any, block: Any, parameters: Any, work: Any) -> None:
    relu, half = splat(_ZERO), (block.length + 1) // 2
    out, windows = rows(work, block.residual, LANES), rows(work, block.input - LANES, LANES)
    weights = rows(parameters, block.residual_weights, LANES)
    bias = rows(parameters, block.residual_bias, 0)
    convolve(out, windows, weights, _THREE, bias, relu, block.length)
    gate_forward(net, block, parameters, work)
    out, windows = rows(work, block.wide, LANES), rows(work, block.sum - LANES, 2 * LANES)
    weights = rows(parameters, block.wide_weights, LANES)
    convolve(out, windows, weights, _THREE, rows(parameters, block.wide_bias, 0), relu, half)
    out, windows = rows(work, block.narrow, LANES), rows(work, block.sum, 2 * LANES)
    weights = rows(parameters, block.narrow_weights, LANES)
    convolve(out, windows, weights, _ONE, rows(parameters, block.narrow_bias, 0), relu, half)
    for t in range(0, half * LANES, LANES):
        both = add(load(work, block.wide + t), load(work, block.narrow + t))
        store(work, block.output + t, both)


@inlined
def _head(net: Any, features: int, parameters: Any, work: Any) -> Any:
    total = splat(_ZERO)
    for t in range(0, net.final * LANES, LANES):
        kept = multiply(load(work, features + t), load(work, net.mask + t))
        total = multiply_add(kept, load(parameters, net.head_weights + t), total)
    return lane_sum(total)


@inlined
def _head_backward(
    net: Any, features: int, parameters: Any, work: Any, grads: Any, slope: Any
) -> None:
    put(grads, net.head_bias, get(grads, net.head_bias) + slope)
    for t in range(0, net.final * LANES, LANES):
        passed = multiply(load(work, net.mask + t), splat(slope))
        at = net.head_weights + t
        store(grads, at, multiply_add(load(work, features + t), passed, load(grads, at)))
        store(work, net.grad + t, multiply(load(parameters, at), passed))


@kernel
def _masked(work: Any, gate: int, grad: int, out: int, count: int) -> None:
    """Pass `count` rows of gradient through the ReLU whose output lies at `gate`."""
    for t in range(0, count * LANES, LANES):
        store(work, out + t, where_positive(load(work, gate + t), load(work, grad + t)))


@inlined
def _block_backward(
    net: Any, block: Any, parameters: Any, back: Any, work: Any, grads: Any
) -> None:
    """Turn d output (at net.grad) into d input, in place."""
    _reduction_backward(net, block, back, work, grads)
    gate_backward(net, block, parameters, work, grads)
    store(work, net.residual_grad + block.length * LANES, splat(_ZERO))  # the padding row
    delta = rows(work, net.residual_grad, LANES)
    weights = rows(grads, block.residual_weights, LANES)
    bias, windows = rows(grads, block.residual_bias, 0), rows(work, block.input - LANES, LANES)
    convolve_gradient(weights, bias, windows, _THREE, delta, block.length)
    out, windows = rows(work, net.grad, LANES), rows(work, net.residual_grad - LANES, LANES)
    weights = rows(back, block.residual_back, LANES)
    convolve(out, windows, weights, _THREE, out, splat(_NO_FLOOR), block.length)


@inlined
def _reduction_backward(net: Any, block: Any, back: Any, work: Any, grads: Any) -> None:
    """Turn d output into d sum.

    Even steps saw the middle tap and the narrow branch; odd steps saw the last tap of one
    window and the first of the next.
    """
    half, free = (block.length + 1) // 2, splat(_NO_FLOOR)
    wide, narrow = rows(work, net.wide_grad, LANES), rows(work, net.narrow_grad, LANES)
    _masked(work, block.wide, net.grad, wide.start, half)
    _masked(work, block.narrow, net.grad, narrow.start, half)
    store(work, wide.start + half * LANES, splat(_ZERO))  # no window follows the last
    _reduction_weights(block, work, grads, wide, narrow, half)
    zeros, even = rows(work, net.zeros, 0), rows(work, net.grad, 2 * LANES)
    convolve(even, wide, rows(back, block.even_back, LANES), _ONE, zeros, free, half)
    convolve(even, narrow, rows(back, block.narrow_back, LANES), _ONE, even, free, half)
    odd, weights = rows(work, net.grad + LANES, 2 * LANES), rows(back, block.odd_back, LANES)
    convolve(odd, wide, weights, _TWO, zeros, free, block.length // 2)


@inlined
def _reduction_weights(
    block: Any, work: Any, grads: Any, wide: Any, narrow: Any, half: int
) -> None:
    windows = rows(work, block.sum - LANES, 2 * LANES)
    weights, bias = rows(grads, block.wide_weights, LANES), rows(grads, block.wide_bias, 0)
    convolve_gradient(weights, bias, windows, _THREE, wide, half)
    windows = rows(work, block.sum, 2 * LANES)
    weights, bias = rows(grads, block.narrow_weights, LANES), rows(grads, block.narrow_bias, 0)
    convolve_gradient(weights, bias, windows, _ONE, narrow, half)


@kernel
def transpose_weights(blocks: Any, parameters: Any, back: Any) -> None:
    """Fill `back`: for each backward product, the weights with in and out features swapped."""
    tap = LANES * LANES
    for i in range(len(blocks)):
        block = blocks[i]
        for k in range(3):
            _transpose(parameters, block.residual_weights + (2 - k) * tap,
                       back, block.residual_back + k * tap)  # fmt: skip
        _transpose(parameters, block.wide_weights + tap, back, block.even_back)
        _transpose(parameters, block.wide_weights + 2 * tap, back, block.odd_back)
        _transpose(parameters, block.wide_weights, back, block.odd_back + tap)
        _transpose(parameters, block.narrow_weights, back, block.narrow_back)


@inlined
def _transpose(source: Any, start: int, target: Any, to: int) -> None:
    for row in range(LANES):
        for column in range(LANES):
            put(target, to + column * LANES + row, get(source, start + row * LANES + column))
