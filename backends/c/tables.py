"""8-bit operators of one value, as tables of 256 results that the runtime itself gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from onnx import TensorProto, helper

from backends.c.operators import Array, Copy, Lookup, Ref, Scale
from backends.c.reading import Node, Reading, UnknownOperatorError, Value
from backends.c.views import sliced, strides_like


def scale(reading: Reading, node: Node, first: int) -> Scale:
    """Return the scale and zero point at two places of a node's inputs, one for all values."""
    factor = reading.array(node.inputs[first])
    zero = np.zeros((), np.uint8)
    if node.given(first + 1):
        zero = reading.array(node.inputs[first + 1])
    if factor.size != 1 or zero.dtype != np.uint8 or not factor.item() > 0:
        raise UnknownOperatorError(node.operator, "of values that are not unsigned 8 bits")
    return Scale(float(factor.item()), int(zero.item()))


def lookup(reading: Reading, node: Node) -> Value:
    """Return any function of one 8-bit value."""
    scale(reading, node, 1), scale(reading, node, 3)
    constants = [reading.array(name) for name in node.inputs[1:]]
    return _looked_up(reading, reading.ref(node.inputs[0]), table(node, [None, *constants]))


def of_constant(reading: Reading, node: Node) -> Value | None:
    """Return a sum or product with one constant, or None where both sides are computed."""
    known = [reading.constants(node.inputs[place]) for place in (0, 3)]
    if not any(known):
        return None
    for place in (1, 4, 6):
        scale(reading, node, place)
    at = 3 if known[0] else 0
    arguments: list[Array | None] = [
        None if place == at else reading.array(name) for place, name in enumerate(node.inputs)
    ]
    constant = arguments[3 - at]
    if constant is None or constant.size != 1:
        raise UnknownOperatorError(node.operator, "with several constants")
    arguments[3 - at] = constant.reshape(1)
    return _looked_up(reading, reading.ref(node.inputs[at]), table(node, arguments))


def concat(reading: Reading, node: Node) -> Value:
    """QLinearConcat: each part brought to the result's scale, at its place."""
    parts = [reading.ref(name) for name in node.inputs[2::3]]
    axis = int(node.attributes["axis"]) % len(parts[0].shape)
    shape = list(parts[0].shape)
    shape[axis] = sum(part.shape[axis] for part in parts)
    y, start = reading.new(tuple(shape), "u8"), 0
    for place, part in enumerate(parts):
        target = sliced(y, axis, start, part.shape[axis])
        start += part.shape[axis]
        if scale(reading, node, 0) == scale(reading, node, 3 * place + 3):
            reading.operators.append(Copy(part, target))
        else:
            reading.operators.append(Lookup(part, target, _rescaled(reading, node, place)))
    return y


def _rescaled(reading: Reading, node: Node, place: int) -> Array:
    first = 3 * place + 2
    names = (*node.inputs[:2], *node.inputs[first + 1 : first + 3])
    to, to_zero, of, of_zero = (reading.array(name) for name in names)
    alone = replace(node, attributes={"axis": 0})
    return table(alone, [to, to_zero, None, of, of_zero])


def _looked_up(reading: Reading, x: Ref, values: Array) -> Ref:
    y = replace(reading.new(x.shape, "u8"), strides=strides_like(x.shape, x.strides))
    reading.operators.append(Lookup(x, y, values))
    return y


def table(node: Node, arguments: Sequence[Array | None]) -> Array:
    """Return what a node gives for 0 to 255 in the place of the argument that is None."""
    from backends.ort import run_feeds

    names = ["x" if value is None else f"c{place}" for place, value in enumerate(arguments)]
    made = helper.make_node(node.operator, names, ["y"], domain="com.microsoft", **node.attributes)
    stored = [
        helper.make_tensor(
            name,
            helper.np_dtype_to_tensor_dtype(value.dtype),
            value.shape,
            value.tobytes(),
            raw=True,
        )
        for name, value in zip(names, arguments, strict=True)
        if value is not None
    ]
    ends = [helper.make_tensor_value_info(n, TensorProto.UINT8, [256]) for n in ("x", "y")]
    graph = helper.make_graph([made], "g", [ends[0]], [ends[1]], stored)
    versions = [helper.make_opsetid("", 20), helper.make_opsetid("com.microsoft", 1)]
    model = helper.make_model(graph, opset_imports=versions, ir_version=8)
    [values] = run_feeds(model, {"x": np.arange(256, dtype=np.uint8)})
    return np.asarray(values)
