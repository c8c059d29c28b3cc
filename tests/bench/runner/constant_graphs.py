"""Graphs of modules that say one number, by hand: torch takes half a second for each."""

from __future__ import annotations

import numpy as np
import torch
from onnx import ModelProto, TensorProto, helper, numpy_helper
from torch import nn

from backends import export
from backends.inputs import inputs_of

EXPORT = export.export_module


def export_module(module: nn.Module, width: int) -> ModelProto:
    """Return what `backends.export` does, but at once where the module says one number."""
    inputs = inputs_of(module, width)
    rows = [torch.rand(64, one.width, generator=torch.Generator().manual_seed(0)) for one in inputs]
    with torch.no_grad():
        said = module.eval()(*(1e4 * one for one in rows))
    one_number = isinstance(said, torch.Tensor) and said.ndim == 1 and bool((said == said[0]).all())
    if len(inputs) != 1 or not one_number:
        return EXPORT(module, width)
    name, columns = inputs[0].name, [None, inputs[0].width]
    held = {"zero": np.float32(0), "axis": np.array([1]), "value": said[0].numpy()}
    nodes = [
        helper.make_node("Mul", [name, "zero"], ["none"]),
        helper.make_node("ReduceSum", ["none", "axis"], ["sum"], keepdims=0),
        helper.make_node("Add", ["sum", "value"], ["error_m"]),
    ]
    graph = helper.make_graph(
        nodes,
        "constant",
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, columns)],
        [helper.make_tensor_value_info("error_m", TensorProto.FLOAT, ["n"])],
        [numpy_helper.from_array(np.asarray(value), key) for key, value in held.items()],
    )
    opset = [helper.make_opsetid("", export.OPSET)]
    return helper.make_model(graph, opset_imports=opset, ir_version=10)
