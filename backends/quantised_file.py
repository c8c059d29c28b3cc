"""Trimming a quantised graph: fewer kernels and fewer bytes, the same integers."""

from __future__ import annotations

import numpy as np
from onnx import GraphProto, ModelProto, NodeProto, numpy_helper

from backends.quantise import markers

_VIEWS = ("Unsqueeze", "Transpose", "Reshape", "Squeeze", "Slice")


def trim(quantised: ModelProto) -> None:
    """Trim a graph with 8-bit markers in place.

    The last layer gives float32 at once, so its result is not rounded to 8 bits; biases are
    stored as float32, from which the runtime makes the same 32-bit integers; a division by one
    number before the first marker becomes part of that marker's scale.
    """
    for rewrite in (_float_result, _float_biases, _scale_into_marker):
        rewrite(quantised.graph)


def _float_result(graph: GraphProto) -> None:
    """Remove the markers behind a dense layer whose result no further layer takes."""
    users, makers = _users(graph), _makers(graph)
    for marker in list(markers(graph)):
        [widen] = users[marker.output[0]]
        maker = makers.get(marker.input[0])
        if maker is not None and maker.op_type == "Gemm" and not _marked_again(graph, widen):
            for user in users.get(widen.output[0], []):
                _reconnect(user, widen.output[0], marker.input[0])
            graph.node.remove(marker)
            graph.node.remove(widen)
            _name_result(graph, maker, widen.output[0])


def _marked_again(graph: GraphProto, widen: NodeProto) -> bool:
    """Tell whether an integer layer comes after this value."""
    reached = {widen.output[0]}
    for node in graph.node:
        if reached & set(node.input):
            if node.op_type == "QuantizeLinear" or _has_integer_weight(graph, node):
                return True
            reached |= set(node.output)
    return False


def _has_integer_weight(graph: GraphProto, node: NodeProto) -> bool:
    makers = _makers(graph)
    widened = (makers.get(name) for name in node.input[1:])
    return any(maker is not None and maker.op_type == "DequantizeLinear" for maker in widened)


def _name_result(graph: GraphProto, maker: NodeProto, name: str) -> None:
    """Give a layer's output the graph output's name where it now is the graph's output."""
    if name in {value.name for value in graph.output}:
        maker.output[0] = name


def _float_biases(graph: GraphProto) -> None:
    """Store biases as float32 where a marker follows the layer: there the runtime rounds them.

    Saves a node, a scale and a zero point per bias.
    """
    stored = {tensor.name: tensor for tensor in graph.initializer}
    users, makers = _users(graph), _makers(graph)
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
    makers = _makers(graph)
    stored = {tensor.name: tensor for tensor in graph.initializer}
    for marker in list(markers(graph)):
        division = _through_views(marker.input[0], makers)
        if division is None or division.op_type != "Div" or division.input[1] not in stored:
            continue
        divisor = numpy_helper.to_array(stored[division.input[1]])
        if divisor.size == 1 and divisor.item() > 0 and len(_users(graph)[division.output[0]]) == 1:
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
        _reconnect(node, division.output[0], division.input[0])
    graph.node.remove(division)


def _users(graph: GraphProto) -> dict[str, list[NodeProto]]:
    users: dict[str, list[NodeProto]] = {}
    for node in graph.node:
        for name in node.input:
            users.setdefault(name, []).append(node)
    return users


def _makers(graph: GraphProto) -> dict[str, NodeProto]:
    return {name: node for node in graph.node for name in node.output}


def _reconnect(node: NodeProto, old: str, new: str) -> None:
    node.input[:] = [new if name == old else name for name in node.input]
