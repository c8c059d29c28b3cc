"""Static 8-bit quantisation: the one call that `int8` and `qat` share."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from onnx import GraphProto, ModelProto, NodeProto, helper

from backends.base import Floats
from backends.graph_file import load_graph
from backends.weights import FLOAT_SLOTS

_BLOCK_ROWS = 128
_BETWEEN = ("Relu", "Clip", "Sigmoid", "Add", "Mul", "MaxPool", "AveragePool", "GlobalAveragePool")
_SCALE, _ZERO_POINT = "_scale", "_zero_point"


@dataclass(frozen=True)
class Range:
    """How a value is held in unsigned 8 bits: value = scale x (stored - zero_point)."""

    scale: float
    zero_point: int


def quantise(
    graph: ModelProto, rows: Floats, learnt: Mapping[str, Range] | None = None
) -> ModelProto:
    """Return the float graph with 8-bit markers (QDQ) around every layer with weights.

    Activations are unsigned 8 bit with one range per value, weights signed 8 bit with one scale
    per output channel. Quantised are the layers with weights and what stands between them; what
    prepares their input stays float32. A ReLU is part of the layer before it.

    Ranges are the extremes over `rows`, float32 [n, width], except those in `learnt`, by value.
    """
    from onnxruntime.quantization import QuantFormat, QuantType, quantize_static

    prepared = _prepared(graph)
    chosen = integer_nodes(prepared.graph)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "quantised.onnx"
        quantize_static(
            prepared,
            target,
            _Rows(rows, prepared.graph.input[0].name),
            quant_format=QuantFormat.QDQ,
            op_types_to_quantize=[*FLOAT_SLOTS, *_BETWEEN],
            nodes_to_quantize=chosen,
            per_channel=True,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            extra_options={"TensorQuantOverrides": _overrides(learnt or {})},
        )
        return load_graph(target)


class _Rows:
    """Hands rows to the calibration, a block at a time."""

    def __init__(self, rows: Floats, name: str) -> None:
        blocks = (rows[i : i + _BLOCK_ROWS] for i in range(0, len(rows), _BLOCK_ROWS))
        self._feeds = iter([{name: block} for block in blocks])

    def get_next(self) -> dict[str, Floats] | None:
        return next(self._feeds, None)


def _overrides(learnt: Mapping[str, Range]) -> dict[str, list[dict[str, object]]]:
    return {
        name: [
            {
                "scale": np.array(found.scale, np.float32),
                "zero_point": np.array(found.zero_point, np.uint8),
            }
        ]
        for name, found in learnt.items()
    }


def _prepared(graph: ModelProto) -> ModelProto:
    """Return a copy with names on all nodes, and means over time as the pooling they are."""
    copy = ModelProto()
    copy.CopyFrom(graph)
    del copy.graph.value_info[:]
    for index, node in enumerate(copy.graph.node):
        node.name = f"{index}:{node.op_type}"
        if node.op_type == "ReduceMean" and _keeps_dimensions(node):
            _pool(copy.graph, node)
    entry = copy.metadata_props.add()  # tells the quantiser that there is nothing left to fold
    entry.key, entry.value = "onnx.quant.pre_process", "onnxruntime.quant"
    return copy


def _keeps_dimensions(node: NodeProto) -> bool:
    return all(entry.i == 1 for entry in node.attribute if entry.name == "keepdims")


def _pool(graph: GraphProto, node: NodeProto) -> None:
    """Turn a mean over the last axis of [n, c, w] into the pooling that has an integer kernel."""
    from onnx import numpy_helper

    axes = [numpy_helper.to_array(t) for t in graph.initializer if t.name == node.input[1]]
    if axes and axes[0].tolist() in ([-1], [2]):
        pooling = helper.make_node("GlobalAveragePool", node.input[:1], node.output, node.name)
        node.CopyFrom(pooling)


def integer_nodes(graph: GraphProto) -> list[str]:
    """Return the names of the layers with weights, and of what stands between them."""
    constants = {tensor.name for tensor in graph.initializer}
    layers = {
        node.name
        for node in graph.node
        if node.op_type in FLOAT_SLOTS and constants & set(node.input)
    }
    after = _reached(list(graph.node), layers)
    before = _reached([_reversed(node) for node in reversed(graph.node)], layers)
    between = {node.name for node in graph.node if node.op_type in _BETWEEN}
    chosen = layers | (between & after & before)
    return [node.name for node in graph.node if node.name in chosen]


def _reached(nodes: list[NodeProto], start: set[str]) -> set[str]:
    """Return the names of nodes that depend on a start node; `nodes` in order of execution."""
    values: set[str] = set()
    names = set()
    for node in nodes:
        if values & set(node.input):
            names.add(node.name)
        if node.name in start | names:
            values |= set(node.output)
    return names


def _reversed(node: NodeProto) -> NodeProto:
    return helper.make_node(node.op_type, node.output, node.input, node.name)


def activation_ranges(quantised: ModelProto) -> dict[str, Range]:
    """Return the range of every value that is quantised, by the value's name."""
    from onnx import numpy_helper

    stored = {t.name: t for t in quantised.graph.initializer}
    found = {}
    for node in markers(quantised.graph):
        scale, zero_point = (numpy_helper.to_array(stored[name]) for name in node.input[1:3])
        name = node.input[1].removesuffix(_SCALE)
        found[name] = Range(float(scale), int(zero_point))
    return found


def markers(graph: GraphProto) -> Iterator[NodeProto]:
    """Yield the nodes that turn a float value into 8 bits."""
    yield from (node for node in graph.node if node.op_type == "QuantizeLinear")
