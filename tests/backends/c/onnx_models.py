"""Small ONNX models for tests of the C generator."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper


def model_of(
    nodes: Iterable[onnx.NodeProto],
    inputs: Sequence[tuple[str, int]],
    tensors: Sequence[tuple[str, Any]] = (),
    output: str = "y",
) -> onnx.ModelProto:
    """Return a model with inputs of these widths by name."""
    ends = [helper.make_tensor_value_info(n, TensorProto.FLOAT, [None, w]) for n, w in inputs]
    result = helper.make_tensor_value_info(output, TensorProto.FLOAT, None)
    stored = [numpy_helper.from_array(np.asarray(v), name) for name, v in tensors]
    graph = helper.make_graph(list(nodes), "g", ends, [result], stored)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)


def saved(model: onnx.ModelProto, folder: Path) -> Path:
    path = folder / "model.onnx"
    path.write_bytes(model.SerializeToString())
    return path
