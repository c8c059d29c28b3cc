"""Who makes and who uses a value of an ONNX graph."""

from __future__ import annotations

from collections.abc import Iterator

from onnx import GraphProto, NodeProto


def users_of(graph: GraphProto) -> dict[str, list[NodeProto]]:
    """Return the nodes that take each value."""
    users: dict[str, list[NodeProto]] = {}
    for node in graph.node:
        for name in node.input:
            users.setdefault(name, []).append(node)
    return users


def makers_of(graph: GraphProto) -> dict[str, NodeProto]:
    """Return the node that makes each value."""
    return {name: node for node in graph.node for name in node.output}


def reconnect(node: NodeProto, old: str, new: str) -> None:
    """Let a node take the value `new` where it took `old`."""
    node.input[:] = [new if name == old else name for name in node.input]


def markers(graph: GraphProto) -> Iterator[NodeProto]:
    """Yield the nodes that turn a float value into 8 bits."""
    yield from (node for node in graph.node if node.op_type == "QuantizeLinear")
