"""Trimming a quantised graph: fewer kernels and fewer bytes, the same integers."""

from __future__ import annotations

import numpy as np
from onnx import GraphProto, ModelProto, NodeProto, numpy_helper

from backends.links import makers_of, markers, reconnect, users_of

_VIEWS = ("Unsqueeze", "Transpose", "Reshape", "Squeeze", "Slice")


def trim(quantised: ModelProto) -> None:
    """Trim a graph with 8-bit markers in place.

    Biases are stored as float32, from which the runtime makes the same 32-bit integers; a
    division by one number before the first marker becomes part of that marker's scale.
    """
    _float_biases(quantised.graph)
    _scale_into_marker(quantised.graph)


def _float_biases(graph: GraphProto) -> None:
    """Store biases as float32 where a marker follows the layer: there the runtime rounds them.

    Saves a node, a scale and a zero point per bias.
    """
    stored = {tensor.name: tensor for tensor in graph.initializer}
    users, makers = users_of(graph), makers_of(graph)
    for layer in [node for node in graph.node if len(node.input) > 2]:
        widen = makers.get(layer.input[2])
        followed = any(user.op_type == "QuantizeLinear" for user in users.get(layer.output[0], []))
        if widen is not None and widen.op_type == "DequantizeLinear" and followed:
            values, scale = (numpy_helper.to_array(stored[name]) for name in widen.input[:2])
            bias = (values * scale.astype(np.float64)).astype(np.float32)
            graph.initializer.append(numpy_helper.from_array(bias, widen.output[0]))
            graph.node.remove(widen)


def _scale_into_marker(graph: GraphProto) -> None:
    """Let the first marker divide: stored = value / (divisor x scale) + zero point."""
    makers = makers_of(graph)
    stored = {tensor.name: tensor for tensor in graph.initializer}
    for marker in list(markers(graph)):
        division = _through_views(marker.input[0], makers)
        if division is None or division.op_type != "Div" or division.input[1] not in stored:
            continue
        divisor = numpy_helper.to_array(stored[division.input[1]])
        if (
            divisor.size == 1
            and divisor.item() > 0
            and len(users_of(graph)[division.output[0]]) == 1
        ):
            _divide_in(graph, marker, division, divisor.item())


def _through_views(name: str, makers: dict[str, NodeProto]) -> NodeProto | None:
    maker = makers.get(name)
    while maker is not None and maker.op_type in _VIEWS:
        maker = makers.get(maker.input[0])
    return maker


def _divide_in(graph: GraphProto, marker: NodeProto, division: NodeProto, divisor: float) -> None:
    old = next(tensor for tensor in graph.initializer if tensor.name == marker.input[1])
    scale = np.asarray(numpy_helper.to_array(old) * np.float32(divisor), np.float32)
    marker.input[1] = f"{old.name}_divided"
    graph.initializer.append(numpy_helper.from_array(scale, marker.input[1]))
    for node in graph.node:
        reconnect(node, division.output[0], division.input[0])
    graph.node.remove(division)
