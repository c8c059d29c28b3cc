"""Weights stored in 16 bits, computed in 32."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from backends.base import Artifact, Backend, Precision, TrainingData
from backends.cost import row_values
from backends.weights import no_weights, weight_names
from zoo.base import MitigationModel, Progress

if TYPE_CHECKING:
    from onnx import ModelProto, TensorProto

FEWEST_VALUES = 16  # below this, the operator that widens them again costs more than it saves


class Fp16Backend(Backend):
    """Weights stored as float16; the processor computes in float32.

    ONNX Runtime's processor kernels have no float16 arithmetic: it would convert every value
    before and after each operator. So this is weight storage, and says so. Inputs, outputs and
    everything between stay float32, as features such as the energy (1e9) exceed float16.
    """

    name: ClassVar[str] = "fp16"
    precision: ClassVar[Precision] = "fp16"

    def supports(self, model: MitigationModel) -> str | None:
        """Return the reason why there is nothing to store, or None."""
        return no_weights(model)

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the graph with its weights in float16 to `path`."""
        from backends.export import export_module
        from backends.graph_file import save_graph

        graph = export_module(model.to_module(), data.cirs.shape[1])
        store_weights_as_halves(graph)
        save_graph(graph, path)
        note = "weights stored as float16, computed in float32"
        return Artifact(path, self.precision, "backends.ort:open_optimised", note)


def store_weights_as_halves(model: ModelProto) -> None:
    """Replace each weight by its float16 values and a cast that widens them when loaded.

    Normalisation constants and weights outside float16's range stay float32.
    """
    from onnx import helper

    graph = model.graph
    weights, casts = weight_names(graph, row_values(model)), []
    for tensor in graph.initializer:
        if tensor.name in weights and _fits_half(tensor):
            casts.append(helper.make_node("Cast", [f"{tensor.name}_half"], [tensor.name], to=1))
            _narrow(tensor)
    nodes = [*casts, *graph.node]
    del graph.node[:]
    graph.node.extend(nodes)


def _fits_half(tensor: TensorProto) -> bool:
    """Tell whether these are weights of some size that float16 holds to its full 11 bits."""
    from onnx import numpy_helper

    values = numpy_helper.to_array(tensor)
    if values.dtype != np.float32 or values.size < FEWEST_VALUES:
        return False
    largest, limits = np.abs(values).max(), np.finfo(np.float16)
    return bool(limits.smallest_normal < largest <= limits.max)


def _narrow(tensor: TensorProto) -> None:
    from onnx import numpy_helper

    halves = numpy_helper.to_array(tensor).astype(np.float16)
    tensor.CopyFrom(numpy_helper.from_array(halves, f"{tensor.name}_half"))
