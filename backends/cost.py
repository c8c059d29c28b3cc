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

Kind = Literal["conv", "dense", "elementwise", "reduce", "move"]
DType = Literal["fp32", "fp16", "int8"]
_REDUCTIONS = ("Reduce", "ArgM", "MaxPool", "AveragePool", "GlobalAveragePool", "QLinearGlobal")
_MOVES = (
    *("Slice", "Gather", "Concat", "Split", "Transpose", "Expand", "Pad", "Cast", "Identity"),
    *("Reshape", "Flatten", "Squeeze", "Unsqueeze", "Shape", "ConstantOfShape", "Range"),
    *("QuantizeLinear", "DequantizeLinear"),
)


@dataclass(frozen=True)
class LayerCost:
    """One kernel of one inference of a single row.

    `macs`: multiply-accumulates of a "conv" or "dense" layer, else 0. `outputs`: values written.
    `dtype`: "int8" where the runtime has an integer kernel for it, "fp16" where the weights are
    stored so (the processor computes those in float32; a device with such units need not), else
    "fp32". "move" copies or converts values.
    """

    kind: Kind
    macs: int
    outputs: int
    dtype: DType
    operator: str


@dataclass(frozen=True)
class GraphCost:
    """What an artifact takes. Kernels are those launched for one call.

    `parameters`: weights and biases, without normalisation constants. `weight_bytes`: what they
    take as stored, with the scales and zero points of 8-bit weights. `file_bytes`: the file.
    """

    file_bytes: int
    weight_bytes: int
    parameters: int
    layers: tuple[LayerCost, ...]

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


def _layers(graph: GraphProto, values: Values) -> tuple[LayerCost, ...]:
    constants = constant_names(graph)
    halves = {name for name, origin in constants.items() if values[origin].dtype == np.float16}
    launched = [node for node in graph.node if node.output[0] not in constants]
    return tuple(_layer(node, values, halves) for node in launched)


def _layer(node: NodeProto, values: Values, halves: set[str]) -> LayerCost:
    written = [values[name] for name in node.output if name]
    dtype: DType = "fp16" if halves & set(node.input) else "fp32"
    if node.op_type in INTEGER_SLOTS or written[0].dtype in (np.uint8, np.int8):
        dtype = "int8"
    outputs = sum(value.size for value in written)
    return LayerCost(_kind(node.op_type), _macs(node, values), outputs, dtype, node.op_type)


def _kind(operator: str) -> Kind:
    if operator in CONVOLUTIONS:
        return "conv"
    if operator in SLOTS:
        return "dense"
    if operator in _MOVES:
        return "move"
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
