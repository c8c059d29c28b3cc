"""Operators that only rearrange: views where memory allows it, copies where it does not."""

from __future__ import annotations

import numpy as np

from backends.c.operators import Array, Ref, Shape, size_of
from backends.c.reading import MOST_ELEMENTS, Flattened, Node, Reading, UnknownOperatorError, Value
from backends.c.views import (
    broadcast,
    contiguous_strides,
    is_contiguous,
    reshaped,
    sliced,
    transposed,
    with_axes,
    without_axes,
)


def identity(reading: Reading, node: Node) -> Value:
    """Identity, and dropout at inference."""
    return reading.values[node.inputs[0]]


def constant_node(_: Reading, node: Node) -> Value:
    """Constant: one that stands among the nodes."""
    for name in ("value", "value_float", "value_floats", "value_int", "value_ints"):
        if name in node.attributes:
            found = np.asarray(node.attributes[name])
            return found.astype(np.float32) if found.dtype == np.float64 else found
    raise UnknownOperatorError("Constant", "of text")


def cast(reading: Reading, node: Node) -> Value:
    """Cast of a constant (half-precision weights), or of a float to what it is already."""
    from onnx import helper

    name, to = node.inputs[0], node.attributes["to"]
    if reading.constants(name):
        found: Array = reading.array(name).astype(helper.tensor_dtype_to_np_dtype(to))
        return found.astype(np.float32) if found.dtype in (np.float16, np.float64) else found
    if to != 1 or reading.dtype(reading.ref(name)) != "f32":
        raise UnknownOperatorError("Cast", f"to type {to}")
    return reading.values[name]


def shape_of(reading: Reading, node: Node) -> Value:
    """Shape: known, as there is one row."""
    shape = reading.shape(node.inputs[0])
    return np.array(shape[node.get("start", 0) : node.get("end", None)], np.int64)


def reshape(reading: Reading, node: Node) -> Value:
    """Reshape, to sizes that are constants; -1 is what is left."""
    wanted = [int(size) for size in reading.array(node.inputs[1]).tolist()]
    name = node.inputs[0]
    have = reading.shape(name)
    if not node.get("allowzero", 0):
        wanted = [have[i] if size == 0 else size for i, size in enumerate(wanted)]
    return as_shape(reading, name, _completed(tuple(wanted), size_of(have)))


def flatten(reading: Reading, node: Node) -> Value:
    """Flatten to two axes."""
    have, axis = reading.shape(node.inputs[0]), node.get("axis", 1)
    return as_shape(reading, node.inputs[0], (size_of(have[:axis]), size_of(have[axis:])))


def _completed(wanted: Shape, size: int) -> Shape:
    known = size_of(tuple(extent for extent in wanted if extent != -1))
    full = tuple(size // max(known, 1) if extent == -1 else extent for extent in wanted)
    if min(full, default=1) < 0 or size_of(full) != size:
        raise ValueError(f"Reshape of {size} elements to {list(wanted)}")
    return full


def as_shape(reading: Reading, name: str, shape: Shape) -> Value:
    """Return a value in another shape."""
    value = reading.values[name]
    if isinstance(value, np.ndarray):
        return value.reshape(shape)
    if isinstance(value, Flattened):
        return Flattened(value.source, shape)
    return reshaped(value, shape) if is_contiguous(value) else Flattened(value, shape)


def unsqueeze(reading: Reading, node: Node) -> Value:
    """Unsqueeze."""
    rank = len(reading.shape(node.inputs[0]))
    axes = _axes(reading, node, 1)
    places = [axis % (rank + len(axes)) for axis in axes]
    value = reading.values[node.inputs[0]]
    if isinstance(value, np.ndarray):
        return np.expand_dims(value, tuple(places))
    return with_axes(reading.ref(node.inputs[0]), places)


def squeeze(reading: Reading, node: Node) -> Value:
    """Squeeze."""
    shape = reading.shape(node.inputs[0])
    axes = [axis % len(shape) for axis in _axes(reading, node, 1)]
    axes = axes or [axis for axis, extent in enumerate(shape) if extent == 1]
    if any(shape[axis] != 1 for axis in axes):
        raise ValueError(f"Squeeze of axes {axes} of {shape}")
    value = reading.values[node.inputs[0]]
    if isinstance(value, np.ndarray):
        return np.squeeze(value, tuple(axes))
    return without_axes(reading.ref(node.inputs[0]), axes)


def _axes(reading: Reading, node: Node, place: int) -> list[int]:
    if node.given(place):
        return [int(axis) for axis in reading.array(node.inputs[place]).reshape(-1)]
    return [int(axis) for axis in node.get("axes", [])]


def transpose(reading: Reading, node: Node) -> Value:
    """Transpose."""
    rank = len(reading.shape(node.inputs[0]))
    order = list(node.get("perm", range(rank)[::-1]))
    if sorted(order) != list(range(rank)):
        raise ValueError(f"Transpose by {order}")
    value = reading.values[node.inputs[0]]
    if isinstance(value, np.ndarray):
        return value.transpose(order)
    return transposed(reading.ref(node.inputs[0]), order)


def expand(reading: Reading, node: Node) -> Value:
    """Expand: repeated by a stride of 0."""
    wanted = tuple(int(size) for size in reading.array(node.inputs[1]).reshape(-1))
    have = reading.shape(node.inputs[0])
    if size_of(wanted) > MOST_ELEMENTS or min(wanted, default=1) < 1:
        raise ValueError(f"Expand to {list(wanted)}: at most {MOST_ELEMENTS} elements")
    shape = np.broadcast_shapes(have, wanted)
    value = reading.values[node.inputs[0]]
    if isinstance(value, np.ndarray):
        return np.broadcast_to(value, shape).copy()
    return broadcast(reading.ref(node.inputs[0]), shape)


def slice_axes(reading: Reading, node: Node) -> Value:
    """Slice by constants."""
    starts, ends = (reading.array(node.inputs[i]).tolist() for i in (1, 2))
    axes = reading.array(node.inputs[3]).tolist() if node.given(3) else range(len(starts))
    steps = reading.array(node.inputs[4]).tolist() if node.given(4) else [1] * len(starts)
    ref = reading.ref(node.inputs[0])
    for start, end, axis, step in zip(starts, ends, axes, steps, strict=True):
        axis %= len(ref.shape)
        taken = range(ref.shape[axis])[start:end:step]
        if step < 1 or not taken:
            raise UnknownOperatorError("Slice", "backwards or of nothing")
        ref = sliced(ref, axis, taken.start, len(taken), step)
    return ref


def gather(reading: Reading, node: Node) -> Value:
    """Gather of one place of an axis, known beforehand."""
    index, axis = reading.array(node.inputs[1]), int(node.get("axis", 0))
    value = reading.values[node.inputs[0]]
    if isinstance(value, np.ndarray):
        return np.asarray(np.take(value, index, axis))
    ref = reading.ref(node.inputs[0])
    axis %= len(ref.shape)
    if index.ndim:
        raise UnknownOperatorError("Gather", "of several places")
    place = range(ref.shape[axis])[int(index)]
    return without_axes(sliced(ref, axis, place, 1), [axis])


def split(reading: Reading, node: Node) -> tuple[Value, ...]:
    """Split along an axis."""
    ref = reading.ref(node.inputs[0])
    axis = int(node.get("axis", 0)) % len(ref.shape)
    parts = len(node.outputs)
    sizes = [-(-ref.shape[axis] // parts)] * (parts - 1)
    sizes = [*sizes, ref.shape[axis] - sum(sizes)]
    if node.given(1):
        sizes = [int(size) for size in reading.array(node.inputs[1])]
    if sum(sizes) != ref.shape[axis] or min(sizes) < 1:
        raise ValueError(f"Split of {ref.shape[axis]} into {sizes}")
    starts = [sum(sizes[:index]) for index in range(len(sizes))]
    return tuple(sliced(ref, axis, s, size) for s, size in zip(starts, sizes, strict=True))


def concat(reading: Reading, node: Node) -> Value:
    """Concat: each part is copied to its place."""
    from backends.c.elementwise import copy_into

    if reading.constants(*node.inputs):
        arrays = [reading.array(name) for name in node.inputs]
        return np.concatenate(arrays, int(node.attributes["axis"]))
    parts = [reading.ref(name) for name in node.inputs]
    axis = int(node.attributes["axis"]) % len(parts[0].shape)
    shape = list(parts[0].shape)
    shape[axis] = sum(part.shape[axis] for part in parts)
    y = reading.new(tuple(shape), reading.dtype(parts[0]))
    start = 0
    for part in parts:
        copy_into(reading, part, sliced(y, axis, start, part.shape[axis]))
        start += part.shape[axis]
    return y


def pad(reading: Reading, node: Node) -> Value:
    """Pad of a float value with a constant."""
    from backends.c.elementwise import copy_into, filled

    if node.get("mode", "constant") != "constant":
        raise UnknownOperatorError("Pad", f"by {node.get('mode', '')}")
    ref = reading.ref(node.inputs[0])
    rank = len(ref.shape)
    pads = [int(size) for size in reading.array(node.inputs[1])]
    if min(pads) < 0 or len(pads) != 2 * rank or node.given(3):
        raise UnknownOperatorError("Pad", "that crops")
    value = float(reading.array(node.inputs[2]).item()) if node.given(2) else 0.0
    shape = tuple(pads[i] + ref.shape[i] + pads[rank + i] for i in range(rank))
    y = filled(reading, shape, value)
    inner = y
    for axis in range(rank):
        inner = sliced(inner, axis, pads[axis], ref.shape[axis])
    copy_into(reading, ref, inner)
    return y


def rows(ref: Ref) -> Ref:
    """Return a value [.., n] as rows [m, n]; it must be contiguous."""
    shape = (size_of(ref.shape[:-1]), ref.shape[-1])
    return Ref(ref.buffer, shape, contiguous_strides(shape), ref.offset)
