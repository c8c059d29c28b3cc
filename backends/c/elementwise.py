"""Float operators that work element by element, and those that reduce along axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from backends.c.operators import (
    Argument,
    Copy,
    Input,
    Loop,
    Number,
    Reduction,
    Ref,
    Result,
    Shape,
    Step,
    Table,
    size_of,
)
from backends.c.reading import Handler, Node, Reading, UnknownOperatorError, Value, canonical
from backends.c.views import broadcast, contiguous_strides, strides_like


def function(name: str, arity: int) -> Handler:
    """Return the handler of an operator that is one function of `arity` values."""

    def handler(reading: Reading, node: Node) -> Value:
        if len(node.inputs) < arity:
            raise ValueError(f"{node.operator} of {len(node.inputs)} values")
        return apply(reading, name, [reading.values[item] for item in node.inputs[:arity]])

    return handler


def apply(reading: Reading, name: str, values: Sequence[Value | float]) -> Ref:
    """Return a function of values, element by element, broadcast by numpy's rule."""
    taken = [item for item in map(_operand, values) if not isinstance(item, Number)]
    shape = np.broadcast_shapes(*(item.shape for item in taken))
    inputs: list[Ref | Table] = []
    arguments: list[Argument] = []
    for item in map(_operand, _readable(reading, values)):
        if not isinstance(item, Number):
            arguments.append(Input(len(inputs)))
            inputs.append(_spread(item, shape))
        else:
            arguments.append(item)
    return _looped(reading, inputs, shape, (Step(name, tuple(arguments)),))


def _readable(reading: Reading, values: Sequence[Value | float]) -> list[Value | float]:
    """Return the values with what is flattened put in order."""
    from backends.c.reading import Flattened
    from backends.c.views import reshaped

    return [
        reshaped(reading.packed(item.source), item.shape) if isinstance(item, Flattened) else item
        for item in values
    ]


def _operand(value: Value | float) -> Value | Number:
    if isinstance(value, float):
        return Number(value)
    if isinstance(value, np.ndarray) and value.size == 1 and value.ndim <= 1:
        return Number(float(np.float32(value.item())))
    return value


def _spread(value: Value, shape: Shape) -> Ref | Table:
    if isinstance(value, Ref):
        return broadcast(value, shape)
    if not isinstance(value, np.ndarray):
        raise TypeError("a value that was not put in order")
    packed = np.ascontiguousarray(value, np.float32)
    strides = np.broadcast_to(packed, shape).strides
    return Table(packed.reshape(-1), tuple(stride // 4 for stride in strides))


def _looped(
    reading: Reading, inputs: Sequence[Ref | Table], shape: Shape, steps: tuple[Step, ...]
) -> Ref:
    refs = [item for item in inputs if isinstance(item, Ref)]
    if any(reading.dtype(ref) != "f32" for ref in refs):
        raise ValueError(f"{steps[0].function} of 8-bit values")
    full = [
        ref for ref in refs if all(s or n == 1 for s, n in zip(ref.strides, shape, strict=True))
    ]
    model = full[0].strides if full else contiguous_strides(shape)
    y = replace(reading.new(shape), strides=strides_like(shape, model))
    reading.operators.append(canonical(Loop(tuple(inputs), y, shape, y.strides, steps)))
    return y


def copy_into(reading: Reading, ref: Ref, y: Ref) -> None:
    """Copy a value into part of another."""
    if reading.dtype(ref) == "u8":
        reading.operators.append(Copy(ref, y))
    else:
        loop = Loop((ref,), y, ref.shape, y.strides, (), kind="copy")
        reading.operators.append(canonical(loop))


def filled(reading: Reading, shape: Shape, value: float) -> Ref:
    """Return a new value, the same everywhere."""
    y = reading.new(shape)
    step = Step("identity", (Number(value),))
    reading.operators.append(canonical(Loop((), y, shape, y.strides, (step,), kind="fill")))
    return y


def leaky_relu(reading: Reading, node: Node) -> Value:
    """LeakyRelu: x, or alpha x below zero."""
    slope = float(node.get("alpha", 0.01))
    return apply(reading, "leaky_relu", [reading.values[node.inputs[0]], slope])


def power(reading: Reading, node: Node) -> Value:
    """Pow with one of the exponents that are products or roots."""
    exponent = float(reading.array(node.inputs[1]).item())
    known = {2.0: "square", 0.5: "sqrt", 1.0: "identity", 3.0: "cube", -1.0: "reciprocal"}
    if exponent not in known:
        raise UnknownOperatorError("Pow", f"with exponent {exponent:g}")
    return apply(reading, known[exponent], [reading.values[node.inputs[0]]])


def clip(reading: Reading, node: Node) -> Value:
    """Clip to constants, either of which may be missing."""
    value: Value = reading.values[node.inputs[0]]
    for place, name in ((1, "max"), (2, "min")):
        if node.given(place):
            limit = float(reading.array(node.inputs[place]).item())
            value = apply(reading, name, [value, limit])
    return value


def several(name: str) -> Handler:
    """Return the handler of an operator of any number of values."""

    def handler(reading: Reading, node: Node) -> Value:
        value = reading.values[node.inputs[0]]
        for other in node.inputs[1:]:
            value = apply(reading, name, [value, reading.values[other]])
        return value

    return handler


def reduction(how: Reduction, body: str | None = None) -> Handler:
    """Return the handler of a reduction along axes that are constants."""

    def handler(reading: Reading, node: Node) -> Value:
        ref = reading.ref(node.inputs[0])
        axes = node.get("axes", None)
        if node.given(1):
            axes = reading.array(node.inputs[1]).tolist()
        return reduce(reading, ref, axes, how, bool(node.get("keepdims", 1)), body)

    return handler


def reduce(
    reading: Reading,
    ref: Ref,
    axes: Sequence[int] | None,
    how: Reduction,
    keep: bool = True,
    body: str | None = None,
) -> Ref:
    """Return a sum, mean or extreme along axes; None means all."""
    rank = len(ref.shape)
    along = {int(axis) % rank for axis in (range(rank) if axes is None else axes)}
    shape = tuple(1 if axis in along else ref.shape[axis] for axis in range(rank))
    y = reading.new(shape)
    strides = tuple(0 if axis in along else y.strides[axis] for axis in range(rank))
    steps = (Step(body, (Input(0),)),) if body else ()
    loop = Loop((ref,), y, ref.shape, strides, steps, how, how)
    reading.operators.append(canonical(loop))
    return y if keep else _dropped(y, along)


def _dropped(y: Ref, along: set[int]) -> Ref:
    shape = tuple(extent for axis, extent in enumerate(y.shape) if axis not in along)
    return Ref(y.buffer, shape, contiguous_strides(shape), y.offset)


def body_result(loop: Loop) -> Argument:
    """Return what a loop's body gives."""
    return Result(len(loop.steps) - 1) if loop.steps else Input(0)


def elements(loop: Loop) -> int:
    """Return how many elements a loop goes through."""
    return size_of(loop.shape)
