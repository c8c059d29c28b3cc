"""The two matrix products a convolution needs, on rows of 16 features.

A convolution over time is `out[r] = start[r] + window[r] @ weights`, where window r is a
contiguous piece of the input that begins r strides on; no im2col copy is made. Its gradients
are the same product with transposed weights, and a sum of outer products. Eight sums stay in
registers, which is what reaches the machine's peak rate.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from zoo.training.fused_remnet.vector import (
    add,
    add_scaled,
    at_least,
    inlined,
    kernel,
    load,
    stay_apart,
    store,
)


class Rows(NamedTuple):
    """Row r starts at `data[start + r * stride]`; data is a pointer to float32."""

    data: Any
    start: int
    stride: int


@kernel
def rows(data: Any, start: int, stride: int) -> Rows:
    """Rows whose numbers are not literals: numba would compile every kernel anew for each."""
    return Rows(data, start, stride)


@inlined
def products(out: Rows, windows: Rows, weights: Rows, width: int, begin: Rows, floor: Any) -> None:
    """Eight rows: out[r] = max(begin[r] + windows[r][:width] @ weights[:width], floor)."""
    b, s = begin.start, begin.stride
    t0, t1 = load(begin.data, b), load(begin.data, b + s)
    t2, t3 = load(begin.data, b + 2 * s), load(begin.data, b + 3 * s)
    t4, t5 = load(begin.data, b + 4 * s), load(begin.data, b + 5 * s)
    t6, t7 = load(begin.data, b + 6 * s), load(begin.data, b + 7 * s)
    x, n = windows.data, windows.stride
    for j in range(width):
        w, i = load(weights.data, weights.start + j * weights.stride), windows.start + j
        t0, t1 = add_scaled(t0, x, i, w), add_scaled(t1, x, i + n, w)
        t2, t3 = add_scaled(t2, x, i + 2 * n, w), add_scaled(t3, x, i + 3 * n, w)
        t4, t5 = add_scaled(t4, x, i + 4 * n, w), add_scaled(t5, x, i + 5 * n, w)
        t6, t7 = add_scaled(t6, x, i + 6 * n, w), add_scaled(t7, x, i + 7 * n, w)
    y, o, k = out.data, out.start, out.stride
    store(y, o, at_least(t0, floor))
    store(y, o + k, at_least(t1, floor))
    store(y, o + 2 * k, at_least(t2, floor))
    store(y, o + 3 * k, at_least(t3, floor))
    store(y, o + 4 * k, at_least(t4, floor))
    store(y, o + 5 * k, at_least(t5, floor))
    store(y, o + 6 * k, at_least(t6, floor))
    store(y, o + 7 * k, at_least(t7, floor))


@inlined
def product(out: Rows, windows: Rows, weights: Rows, width: int, begin: Rows, floor: Any) -> None:
    """One row of `products`."""
    total = load(begin.data, begin.start)
    for j in range(width):
        w = load(weights.data, weights.start + j * weights.stride)
        total = add_scaled(total, windows.data, windows.start + j, w)
    store(out.data, out.start, at_least(total, floor))


@inlined
def below(where: Rows, count: int) -> Rows:
    """Return the rows from number `count` on."""
    return Rows(where.data, where.start + count * where.stride, where.stride)


@kernel
def convolve(
    out: Rows, windows: Rows, weights: Rows, width: int, begin: Rows, floor: Any, count: int
) -> None:
    """`products` for `count` rows: eight at a time, then one at a time."""
    stay_apart()
    row = 0
    while row + 8 <= count:
        products(below(out, row), below(windows, row), weights, width, below(begin, row), floor)
        row += 8
    while row < count:
        product(below(out, row), below(windows, row), weights, width, below(begin, row), floor)
        row += 1


@inlined
def outer_sums(into: Rows, windows: Rows, grads: Rows, count: int) -> None:
    """Eight weights rows: into[j] += sum over r < count of windows[r][j] * grads[r]."""
    g, o = into.data, into.start
    t0, t1, t2, t3 = load(g, o), load(g, o + 16), load(g, o + 32), load(g, o + 48)
    t4, t5, t6, t7 = load(g, o + 64), load(g, o + 80), load(g, o + 96), load(g, o + 112)
    x = windows.data
    for r in range(count):
        d, i = load(grads.data, grads.start + r * grads.stride), windows.start + r * windows.stride
        t0, t1 = add_scaled(t0, x, i, d), add_scaled(t1, x, i + 1, d)
        t2, t3 = add_scaled(t2, x, i + 2, d), add_scaled(t3, x, i + 3, d)
        t4, t5 = add_scaled(t4, x, i + 4, d), add_scaled(t5, x, i + 5, d)
        t6, t7 = add_scaled(t6, x, i + 6, d), add_scaled(t7, x, i + 7, d)
    store(g, o, t0)
    store(g, o + 16, t1)
    store(g, o + 32, t2)
    store(g, o + 48, t3)
    store(g, o + 64, t4)
    store(g, o + 80, t5)
    store(g, o + 96, t6)
    store(g, o + 112, t7)


@kernel
def row_sum(into: Rows, grads: Rows, count: int) -> None:
    """into[0] += sum of the first `count` rows of grads, in four interleaved sums."""
    t0, g, n = load(into.data, into.start), grads.data, grads.stride
    row = 0
    if count >= 4:
        t0 = add(t0, load(g, grads.start))
        t1, t2 = load(g, grads.start + n), load(g, grads.start + 2 * n)
        t3 = load(g, grads.start + 3 * n)
        row = 4
        while row + 4 <= count:
            i = grads.start + row * n
            t0, t1 = add(t0, load(g, i)), add(t1, load(g, i + n))
            t2, t3 = add(t2, load(g, i + 2 * n)), add(t3, load(g, i + 3 * n))
            row += 4
        t0 = add(add(t0, t1), add(t2, t3))
    while row < count:
        t0 = add(t0, load(g, grads.start + row * n))
        row += 1
    store(into.data, into.start, t0)


@kernel
def convolve_gradient(
    weights: Rows, bias: Rows, windows: Rows, width: int, grads: Rows, count: int
) -> None:
    """Add to `weights` [width rows] and `bias` what `count` output gradients ask of them.

    `width` is a multiple of eight, or the caller leaves room for the rows up to the next one.
    """
    stay_apart()
    for j in range(0, width, 8):
        shifted = rows(windows.data, windows.start + j, windows.stride)
        outer_sums(below(weights, j), shifted, grads, count)
    row_sum(bias, grads, count)
