"""Strided views: what reshaping, cropping, transposing and broadcasting do to a `Ref`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from backends.c.operators import Ref, Shape, size_of


def contiguous_strides(shape: Shape) -> Shape:
    """Return the strides of an array stored row by row."""
    strides = []
    step = 1
    for extent in reversed(shape):
        strides.append(step)
        step *= extent
    return tuple(reversed(strides))


def is_contiguous(ref: Ref) -> bool:
    """Tell whether the elements lie one after another; axes of one element do not count."""
    wanted = contiguous_strides(ref.shape)
    return all(
        extent == 1 or stride == want
        for extent, stride, want in zip(ref.shape, ref.strides, wanted, strict=True)
    )


def strides_like(shape: Shape, model: Shape) -> Shape:
    """Return strides for a packed array [*shape] whose axes are nested as in strides `model`."""
    order = sorted(range(len(shape)), key=lambda axis: -model[axis])
    strides = [0] * len(shape)
    step = 1
    for axis in reversed(order):
        strides[axis] = step
        step *= shape[axis]
    return tuple(strides)


def reshaped(ref: Ref, shape: Shape) -> Ref:
    """Return a contiguous ref in another shape."""
    return Ref(ref.buffer, shape, contiguous_strides(shape), ref.offset)


def transposed(ref: Ref, order: Sequence[int]) -> Ref:
    """Return the ref with its axes in another order."""
    shape = tuple(ref.shape[axis] for axis in order)
    return replace(ref, shape=shape, strides=tuple(ref.strides[axis] for axis in order))


def sliced(ref: Ref, axis: int, start: int, count: int, step: int = 1) -> Ref:
    """Return every `step`-th of an axis from `start` on, `count` of them."""
    shape, strides = list(ref.shape), list(ref.strides)
    offset = ref.offset + start * strides[axis]
    shape[axis], strides[axis] = count, strides[axis] * step
    return Ref(ref.buffer, tuple(shape), tuple(strides), offset)


def without_axes(ref: Ref, axes: Sequence[int]) -> Ref:
    """Return the ref without axes of one element."""
    kept = [axis for axis in range(len(ref.shape)) if axis not in axes]
    return replace(
        ref,
        shape=tuple(ref.shape[axis] for axis in kept),
        strides=tuple(ref.strides[axis] for axis in kept),
    )


def with_axes(ref: Ref, axes: Sequence[int]) -> Ref:
    """Return the ref with axes of one element where `axes` says, in the new shape."""
    shape, strides = list(ref.shape), list(ref.strides)
    for axis in sorted(axes):
        shape.insert(axis, 1)
        strides.insert(axis, 0)
    return replace(ref, shape=tuple(shape), strides=tuple(strides))


def broadcast(ref: Ref, shape: Shape) -> Ref:
    """Return the ref repeated to `shape` by numpy's rule. Raises ValueError where it cannot be."""
    ref = with_axes(ref, range(len(shape) - len(ref.shape)))
    if any(have not in (1, want) for have, want in zip(ref.shape, shape, strict=True)):
        raise ValueError(f"cannot broadcast {ref.shape} to {shape}")
    strides = tuple(
        0 if have == 1 else stride for have, stride in zip(ref.shape, ref.strides, strict=True)
    )
    return replace(ref, shape=shape, strides=strides)


def rows_layout(ref: Ref) -> Ref | None:
    """Return maps [1, c, w] as rows [w, c] where they are stored so, else None."""
    rows = without_axes(transposed(ref, (0, 2, 1)), (0,))
    return reshaped(rows, rows.shape) if is_contiguous(rows) else None


def covers(ref: Ref, size: int) -> bool:
    """Tell whether a contiguous ref is all of a buffer of `size` elements."""
    return ref.offset == 0 and size_of(ref.shape) == size and is_contiguous(ref)
