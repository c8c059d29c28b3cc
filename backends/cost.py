"""What one inference costs, counted from the ONNX file: the input of every energy estimate."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from backends.weights import (
    CONVOLUTIONS,
    INTEGER_SLOTS,
    SLOTS,
    Values,
    constant_names,
    scale_names,
    tree_values,
    weight_names,
)

if TYPE_CHECKING:
    from onnx import GraphProto, ModelProto, NodeProto

Kind = Literal[
    "conv", "dense", "elementwise", "activation", "function", "reduce", "trees", "convert", "move"
]
DType = Literal["fp32", "fp16", "int8"]
_ACTIVATIONS = ("Relu", "LeakyRelu", "PRelu", "Clip", "HardSigmoid")
_FUNCTIONS = ("Exp", "Log", "Sigmoid", "Tanh", "Erf", "Softplus", "Sin", "Cos")
_TREES = ("TreeEnsembleRegressor",)
_REDUCTIONS = ("Reduce", "ArgM", "MaxPool", "AveragePool", "GlobalAveragePool", "QLinearGlobal")
_MOVES = (
    *("Slice", "Gather", "Concat", "Split", "Transpose", "Expand", "Pad", "Cast", "Identity"),
    *("Reshape", "Flatten", "Squeeze", "Unsqueeze", "Shape", "ConstantOfShape", "Range"),
)
_BY_NAME: dict[Kind, tuple[str, ...]] = {
    "activation": _ACTIVATIONS,
    "function": _FUNCTIONS,
    "trees": _TREES,
    "convert": ("QuantizeLinear", "DequantizeLinear"),
}


@dataclass(frozen=True)
class LayerCost:
    """One kernel of one inference of a single row.

    `macs`: multiply-accumulates of a "conv" or "dense" layer, else 0. `outputs`: values written.
    `reads`: values read that are no constants; of "trees" the nodes on the way to a leaf. An
    "activation" is what a generator of code joins to the layer before it, a "function" takes
    more than a few multiplications for each value.
    `dtype`: "int8" where the runtime has an integer kernel for it, "fp16" where the weights are
    stored so (the processor computes those in float32; a device with such units need not), else
    "fp32". "move" copies values, "convert" makes 8-bit ones of them or the other way round.
    """

    kind: Kind
    macs: int
    outputs: int
    dtype: DType
    operator: str
    reads: int


@dataclass(frozen=True)
class GraphCost:
    """What an artifact takes. Kernels are those launched for one call.

    `parameters`: weights and biases, without normalisation constants. `weight_bytes`: what they
    take as stored, with the scales and zero points of 8-bit weights. `file_bytes`: the file.
    `inputs`: values a row holds.
    """

    file_bytes: int
    weight_bytes: int
    parameters: int
    layers: tuple[LayerCost, ...]
    inputs: int

    @property
    def macs(self) -> int:
        """Multiply-accumulates of one inference of a single row."""
        return sum(layer.macs for layer in self.layers)

    @property
    def kernels(self) -> int:
        """How many kernels one call launches."""
        return len(self.layers)


def graph_cost(path: Path) -> GraphCost:
    """Return the cost of one inference of a single row, from a float, fp16 or 8-bit ONNX file.

    A float file is counted as it stands, so a graph saved after fusion costs fewer kernels. A file
    with 8-bit markers (QuantizeLinear, DequantizeLinear) is counted as the runtime fuses it,
    before the rewrites for one processor's memory layout. Widening float16 weights is no kernel:
    that is done once, on loading. Raises ValueError where the file is no ONNX model.
    """
    from backends.graph_file import load_graph

    graph = _fused(path, load_graph(path))
    values = row_values(graph)
    weights = weight_names(graph.graph, values)
    stored = [*(values[name] for name in weights), *tree_values(graph.graph)]
    scales = [values[name] for name in scale_names(graph.graph)]
    return GraphCost(
        file_bytes=path.stat().st_size,
        weight_bytes=sum(value.nbytes for value in (*stored, *scales)),
        parameters=sum(value.size for value in stored),
        layers=_layers(graph.graph, values),
        inputs=_inputs(graph, values),
    )


def _fused(path: Path, model: ModelProto) -> ModelProto:
    from backends.ort import executed_graph

    marked = any(node.op_type == "QuantizeLinear" for node in model.graph.node)
    return executed_graph(path, "extended") if marked else model


def row_values(model: ModelProto) -> Values:
    """Return every value for one row of ones, constants included.

    Shapes and types are read off this run, since fused operators have no shape rules in ONNX.
    """
    from onnx import ModelProto, ValueInfoProto, numpy_helper

    from backends.inputs import feeds, row_of_ones
    from backends.ort import run_once

    probe = ModelProto()
    probe.CopyFrom(model)
    names = [name for node in model.graph.node for name in node.output if name]
    del probe.graph.output[:]
    probe.graph.output.extend(ValueInfoProto(name=name) for name in names)
    row = row_of_ones(model)
    values = feeds(model, row)
    values |= {entry.name: numpy_helper.to_array(entry) for entry in model.graph.initializer}
    return values | dict(zip(names, run_once(probe, row), strict=True))


def _inputs(graph: ModelProto, values: Values) -> int:
    from backends.inputs import graph_inputs

    return sum(values[one.name].size for one in graph_inputs(graph))


def _layers(graph: GraphProto, values: Values) -> tuple[LayerCost, ...]:
    constants = constant_names(graph)
    halves = {name for name, origin in constants.items() if values[origin].dtype == np.float16}
    launched = [node for node in graph.node if node.output[0] not in constants]
    return tuple(_layer(node, values, halves, set(constants)) for node in launched)


def _layer(node: NodeProto, values: Values, halves: set[str], constants: set[str]) -> LayerCost:
    written = [values[name] for name in node.output if name]
    dtype: DType = "fp16" if halves & set(node.input) else "fp32"
    if node.op_type in INTEGER_SLOTS or written[0].dtype in (np.uint8, np.int8):
        dtype = "int8"
    outputs = sum(value.size for value in written)
    kind, macs, reads = _kind(node.op_type), _macs(node, values), _reads(node, values, constants)
    return LayerCost(kind, macs, outputs, dtype, node.op_type, reads)


def _reads(node: NodeProto, values: Values, constants: set[str]) -> int:
    from backends.trees import nodes_passed

    if node.op_type in _TREES:
        return nodes_passed(node)
    return sum(values[name].size for name in {*node.input} - constants if name)


def _kind(operator: str) -> Kind:
    if operator in CONVOLUTIONS:
        return "conv"
    if operator in SLOTS:
        return "dense"
    if operator in _MOVES:
        return "move"
    for kind, operators in _BY_NAME.items():
        if operator in operators:
            return kind
    return "reduce" if operator.startswith(_REDUCTIONS) else "elementwise"


def _macs(node: NodeProto, values: Values) -> int:
    """Return the products summed: each output of a layer takes one per input it looks at."""
    slots = SLOTS.get(node.op_type)
    if slots is None:
        return 0
    weight, outputs = values[node.input[slots.weight]].shape, values[node.output[0]].size
    if node.op_type in CONVOLUTIONS:
        return outputs * int(np.prod(weight[1:]))  # [out, in / groups, kernel]
    transposed = any(entry.name == "transB" and entry.i for entry in node.attribute)
    return outputs * int(weight[-1 if transposed or len(weight) == 1 else -2])
