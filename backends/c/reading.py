"""What both readers share: a graph of one row, its constants, and the checks on hostile files."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from onnx import GraphProto, ModelProto, NodeProto, TensorProto, helper, numpy_helper

from backends.c.operators import (
    Array,
    Buffer,
    Copy,
    Dtype,
    Loop,
    Operator,
    Program,
    Ref,
    Shape,
    reads,
    size_of,
)
from backends.c.views import contiguous_strides, is_contiguous, reshaped, strides_like

MOST_ELEMENTS = 1 << 20  # of one value; no microcontroller holds a fraction of it
MOST_BYTES = 64 << 20
MOST_NODES = 4096
_CONSTANTS = {
    TensorProto.FLOAT,
    TensorProto.FLOAT16,
    TensorProto.DOUBLE,
    TensorProto.INT64,
    TensorProto.INT32,
    TensorProto.INT8,
    TensorProto.UINT8,
    TensorProto.BOOL,
}


@dataclass(frozen=True)
class Flattened:
    """A ref that is not stored in the order it is wanted in; `shape` is what it became."""

    source: Ref
    shape: Shape


Value = Ref | Flattened | Array


@dataclass(frozen=True)
class Node:
    """A node of the graph: operator, names of inputs and outputs, attributes by name."""

    operator: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    attributes: Mapping[str, Any]

    @classmethod
    def of(cls, node: NodeProto) -> Node:
        """Return a node of a file. Raises ValueError for graphs within graphs."""
        found = {entry.name: helper.get_attribute_value(entry) for entry in node.attribute}
        if any(isinstance(value, GraphProto) for value in found.values()):
            raise UnknownOperatorError(node.op_type)
        plain = {name: _plain(value) for name, value in found.items()}
        return cls(node.op_type, tuple(node.input), tuple(node.output), plain)

    def get(self, name: str, default: Any) -> Any:
        """Return an attribute, or what it is where the file does not say."""
        return self.attributes.get(name, default)

    def given(self, place: int) -> bool:
        """Tell whether the n-th input is there."""
        return place < len(self.inputs) and self.inputs[place] != ""


def _plain(value: Any) -> Any:
    if isinstance(value, TensorProto):
        return constant(value)
    return value.decode(errors="replace") if isinstance(value, bytes) else value


class UnknownOperatorError(ValueError):
    """An operator that C cannot be written for."""

    def __init__(self, operator: str, detail: str = "") -> None:
        super().__init__(
            f"operator {operator!r}{detail and ' ' + detail} is not one that C can be written for"
        )


class Reading:
    """A graph on its way to a list of operators."""

    def __init__(self) -> None:
        self.values: dict[str, Value] = {}
        self.buffers: list[Buffer] = []
        self.operators: list[Operator] = []

    def new(self, shape: Shape, dtype: Dtype = "f32", name: str | None = None) -> Ref:
        """Return a new contiguous buffer. Raises ValueError where it is too large."""
        _check_size(shape)
        self.buffers.append(Buffer(size_of(shape), dtype, name))
        return Ref(len(self.buffers) - 1, shape, contiguous_strides(shape))

    def array(self, name: str) -> Array:
        """Return a constant. Raises ValueError for a value that depends on the input."""
        value = self.values[name]
        if not isinstance(value, np.ndarray):
            raise ValueError(f"value {name!r} has to be a constant")
        return value

    def constants(self, *names: str) -> bool:
        """Tell whether all of these values are constants."""
        return all(isinstance(self.values[name], np.ndarray) for name in names if name)

    def ref(self, name: str) -> Ref:
        """Return a value that is computed, in its shape. Raises ValueError for a constant."""
        value = self.values[name]
        if isinstance(value, Flattened):
            value = self.values[name] = reshaped(self.packed(value.source), value.shape)
        if not isinstance(value, Ref):
            raise ValueError(f"value {name!r} must not be a constant here")
        return value

    def packed(self, ref: Ref) -> Ref:
        """Return the same array in a contiguous stretch of memory, copied where it is not yet."""
        return ref if is_contiguous(ref) else self.copied(ref, contiguous_strides(ref.shape))

    def copied(self, ref: Ref, strides: Shape) -> Ref:
        """Return a copy in a buffer of its own, nested like `strides`."""
        dtype = self.buffers[ref.buffer].dtype
        packed = strides_like(ref.shape, strides)
        y = Ref(self.new(ref.shape, dtype).buffer, ref.shape, packed)
        loop = Loop((ref,), y, ref.shape, packed, (), kind="copy")
        self.operators.append(canonical(loop) if dtype == "f32" else Copy(ref, y))
        return y

    def shape(self, name: str) -> Shape:
        """Return the shape of any value."""
        return tuple(self.values[name].shape)

    def dtype(self, ref: Ref) -> Dtype:
        """Return what the buffer of a ref holds."""
        return self.buffers[ref.buffer].dtype


Handler = Callable[[Reading, Node], Value | tuple[Value, ...]]


def read(model: ModelProto, handlers: Mapping[str, Handler]) -> Program:
    """Return a graph as operators on one row; its first output is the result.

    Raises ValueError (`UnknownOperatorError` with the operator's name) for what C cannot be written
    for, for values larger than `MOST_ELEMENTS`, and for nodes that are not in order of execution.
    """
    graph = model.graph
    _check_graph(model)
    reading = Reading()
    _read_constants(reading, graph)
    inputs = _read_inputs(reading, graph)
    for proto in graph.node:
        _read_node(reading, Node.of(proto), handlers)
    result = _result(reading, graph)
    return Program(_needed(reading, result), tuple(reading.buffers), inputs, result)


def _needed(reading: Reading, result: Ref) -> tuple[Operator, ...]:
    """Return the operators that the result depends on: a graph may give more than the error."""
    wanted = {result.buffer}
    kept: list[Operator] = []
    for operator in reversed(reading.operators):
        if operator.y.buffer in wanted:
            kept.append(operator)
            wanted |= {ref.buffer for ref in reads(operator)}
    return tuple(reversed(kept))


def check(model: ModelProto) -> None:
    """Raise ValueError for a graph that is too large, out of order, or of odd constants."""
    _check_graph(model)
    reading = Reading()
    _read_constants(reading, model.graph)
    _read_inputs(reading, model.graph)
    known = set(reading.values)
    for proto in model.graph.node:
        node = Node.of(proto)
        _check_order(node, known)
        known |= set(node.outputs)


def _check_graph(model: ModelProto) -> None:
    graph = model.graph
    if len(graph.node) > MOST_NODES:
        raise ValueError(f"{len(graph.node)} nodes, at most {MOST_NODES} are taken")
    if model.functions or graph.sparse_initializer:
        raise ValueError("functions and sparse constants are not taken")


def _read_constants(reading: Reading, graph: GraphProto) -> None:
    for tensor in graph.initializer:
        reading.values[tensor.name] = constant(tensor)


def constant(tensor: TensorProto) -> Array:
    """Return a constant of a file. Raises ValueError where it is hostile or of an odd type."""
    if tensor.data_location == TensorProto.EXTERNAL or tensor.external_data:
        raise ValueError("refers to weights in other files, which is not allowed")
    if tensor.data_type not in _CONSTANTS:
        raise ValueError(f"constant {tensor.name!r} is of a type that is not taken")
    _check_size(tuple(tensor.dims))
    values: Array = numpy_helper.to_array(tensor)
    return values.astype(np.float32) if values.dtype in (np.float16, np.float64) else values


def _check_size(shape: Shape) -> None:
    if any(extent < 0 for extent in shape) or prod(shape) > MOST_ELEMENTS:
        raise ValueError(f"a value of shape {list(shape)}: at most {MOST_ELEMENTS} elements")


def _read_inputs(reading: Reading, graph: GraphProto) -> tuple[int, ...]:
    found = []
    for entry in graph.input:
        if entry.name in reading.values:
            continue  # older files list constants here too
        tensor = entry.type.tensor_type
        sizes = [dim.dim_value for dim in tensor.shape.dim]
        if tensor.elem_type != TensorProto.FLOAT or len(sizes) != 2 or sizes[1] < 1:
            raise ValueError(f"input {entry.name!r} is not float32 [n, width] of a known width")
        reading.values[entry.name] = reading.new((1, sizes[1]), name=entry.name)
        found.append(len(reading.buffers) - 1)
    if not found:
        raise ValueError("no input")
    return tuple(found)


def _read_node(reading: Reading, node: Node, handlers: Mapping[str, Handler]) -> None:
    if node.operator not in handlers:
        raise UnknownOperatorError(node.operator)
    _check_order(node, reading.values)
    try:
        made = handlers[node.operator](reading, node)
    except (IndexError, KeyError, TypeError, AttributeError, OverflowError) as problem:
        raise ValueError(f"{node.operator} is malformed ({problem})") from problem
    values = made if isinstance(made, tuple) else (made,)
    for name, value in zip(node.outputs, values, strict=False):
        if name in reading.values:
            raise ValueError(f"value {name!r} is made twice")
        _check_size(tuple(value.shape))
        reading.values[name] = value


def _check_order(node: Node, known: Collection[str]) -> None:
    for name in node.inputs:
        if name and name not in known:
            raise ValueError(f"{node.operator} takes {name!r} before it is made: a cycle?")


def _result(reading: Reading, graph: GraphProto) -> Ref:
    name = graph.output[0].name
    if name not in reading.values:
        raise ValueError(f"the output {name!r} is never made")
    if size_of(reading.shape(name)) != 1:
        raise ValueError(f"the output has shape {reading.shape(name)}, expected one number a row")
    if isinstance(reading.values[name], np.ndarray):
        return _constant_result(reading, float(reading.array(name).item()))
    ref = reading.ref(name)
    if reading.dtype(ref) != "f32":
        raise ValueError("the output is not float32")
    return ref


def _constant_result(reading: Reading, value: float) -> Ref:
    from backends.c.operators import Number, Step

    y = reading.new((1,))
    reading.operators.append(Loop((), y, (), (), (Step("identity", (Number(value),)),)))
    return y


def canonical(loop: Loop) -> Loop:
    """Return a loop without axes of one element, the axis of the longest stride first."""
    leading = loop.strides
    if loop.reduction is not None:
        leading = loop.inputs[0].strides
    kept = [axis for axis, extent in enumerate(loop.shape) if extent != 1]
    kept.sort(key=lambda axis: -leading[axis])
    return _with_axes(loop, kept)


def _with_axes(loop: Loop, kept: list[int]) -> Loop:
    from dataclasses import replace

    shape = tuple(loop.shape[axis] for axis in kept)
    inputs = []
    for item in loop.inputs:
        strides = tuple(item.strides[axis] for axis in kept)
        changed = (
            replace(item, shape=shape, strides=strides)
            if isinstance(item, Ref)
            else replace(item, strides=strides)
        )
        inputs.append(changed)
    strides = tuple(loop.strides[axis] for axis in kept)
    return replace(loop, shape=shape, strides=strides, inputs=tuple(inputs))


def load_checked(path: Path) -> ModelProto:
    """Return the ONNX model in a file. Raises ValueError as `load_graph`, or where it is large."""
    from backends.graph_file import load_graph

    try:
        size = path.stat().st_size
    except OSError as problem:
        raise ValueError(f"{path}: cannot be read ({problem.strerror})") from problem
    if size > MOST_BYTES:
        raise ValueError(f"{path}: {size} bytes, at most {MOST_BYTES} are taken")
    return load_graph(path)
