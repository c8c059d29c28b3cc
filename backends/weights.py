"""Which constants of a graph are weights: what was fitted, beside normalisation and shapes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from onnx import GraphProto, NodeProto

    from zoo.base import MitigationModel

Values = Mapping[str, NDArray[Any]]
"""Values of a graph by name."""


@dataclass(frozen=True)
class Slots:
    """Where an operator takes its weight, the weight's scale and zero point, and its bias."""

    weight: int
    bias: int | None = None
    scale: int | None = None
    zero_point: int | None = None


FLOAT_SLOTS: Mapping[str, Slots] = {
    "Conv": Slots(1, 2),
    "FusedConv": Slots(1, 2),
    "Gemm": Slots(1, 2),
    "FusedGemm": Slots(1, 2),
    "MatMul": Slots(1),
    "FusedMatMul": Slots(1),
}
INTEGER_SLOTS: Mapping[str, Slots] = {
    "QLinearConv": Slots(3, 8, 4, 5),
    "QGemm": Slots(3, 6, 4, 5),
    "QLinearMatMul": Slots(3, None, 4, 5),
    "ConvInteger": Slots(1, None, None, 3),
    "MatMulInteger": Slots(1, None, None, 3),
}
SLOTS: Mapping[str, Slots] = {**FLOAT_SLOTS, **INTEGER_SLOTS}
CONVOLUTIONS = ("Conv", "FusedConv", "QLinearConv", "ConvInteger")
_PAIRWISE = ("Sub", "Add", "Mul", "Div")


def constant_names(graph: GraphProto) -> dict[str, str]:
    """Return each constant value's name and the initialiser behind it (itself, or one cast)."""
    names = {tensor.name: tensor.name for tensor in graph.initializer}
    for node in graph.node:
        if node.op_type == "Cast" and node.input[0] in names:
            names[node.output[0]] = names[node.input[0]]
    return names


def weight_names(graph: GraphProto, values: Values) -> set[str]:
    """Return the initialisers that are weights or biases.

    Those of convolutions, dense layers and matrix products; the vector added to a product; and
    constants that are only ever used to widen something, as the support vectors of a kernel
    machine do ([n, 1] - [vectors] -> [n, vectors]). A normalisation or a time axis meets values
    of its own size somewhere. `values` are those of one row, from `backends.cost.row_values`.
    """
    constants = constant_names(graph)
    products = {node.output[0] for node in graph.node if node.op_type in ("MatMul", "FusedMatMul")}
    uses: dict[str, set[str]] = {"layer": set(), "widen": set(), "other": set()}
    for node in (node for node in graph.node if node.output[0] not in constants):
        for name in constants.keys() & set(node.input):
            uses[_use(node, name, values, products)].add(constants[name])
    return uses["layer"] | (uses["widen"] - uses["other"])


def tree_values(graph: GraphProto) -> list[NDArray[np.float32]]:
    """Return what was fitted in trees: the thresholds and the values of their leaves."""
    return [
        np.array(entry.floats, np.float32)
        for node in graph.node
        for entry in node.attribute
        if entry.name in ("nodes_values", "target_weights")
    ]


def scale_names(graph: GraphProto) -> set[str]:
    """Return the initialisers that hold scales and zero points of 8-bit weights."""
    named = set()
    for node in graph.node:
        if slots := INTEGER_SLOTS.get(node.op_type):
            named |= set(_at(node, slots.scale, slots.zero_point))
    return named & {tensor.name for tensor in graph.initializer}


def _use(node: NodeProto, name: str, values: Values, products: set[str]) -> str:
    """Return what a node does with a constant: "layer", "widen" or "other"."""
    slots = SLOTS.get(node.op_type)
    if slots:
        return "layer" if name in _at(node, slots.weight, slots.bias) else "other"
    others = [other for other in node.input if other != name]
    if node.op_type not in _PAIRWISE or not others:
        return "other"
    if node.op_type == "Add" and others[0] in products:
        return "layer"  # the bias of a matrix product
    return "widen" if values[node.output[0]].size > values[others[0]].size else "other"


def _at(node: NodeProto, *places: int | None) -> Iterator[str]:
    for place in places:
        if place is not None and place < len(node.input) and node.input[place]:
            yield node.input[place]


def no_weights(model: MitigationModel) -> str | None:
    """Return the reason, in words, where the fitted model has no weights, else None.

    Constants kept as buffers are none, and the values of trees have no other form than float32.
    """
    from backends.trees import tree_tail

    module = model.to_module()
    if tree_tail(module) is not None:
        return f"{type(model).__name__} is made of trees, which ONNX keeps in float32 alone"
    held = sum(value.numel() for value in module.parameters())
    return None if held else f"{type(model).__name__} has no weights"
