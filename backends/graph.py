"""float32 with the runtime's graph optimisation."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from backends.base import Artifact, Backend, Precision, TrainingData

if TYPE_CHECKING:
    from onnx import ModelProto

    from zoo.base import MitigationModel, Progress


class GraphBackend(Backend):
    """ONNX Runtime in float32 with all graph optimisation, saved.

    What is saved is the graph after the optimisations that hold anywhere (constants folded,
    activations fused into convolutions and dense layers: level "extended"). Those of the last
    level lay memory out for one processor's vector width, and a file with them runs badly or not
    at all on another; so they are left to whoever opens the file, with everything switched on.
    """

    name: ClassVar[str] = "graph"
    precision: ClassVar[Precision] = "fp32"
    opener: ClassVar[str] = "backends.ort:open_optimised"
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is trained

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the optimised graph to `path`."""
        from backends.export import export_module
        from backends.graph_file import save_graph

        save_graph(optimised(export_module(model.to_module(), data.cirs.shape[1])), path)
        note = "operators fused by the runtime; memory layouts chosen when opened"
        return Artifact(path, self.precision, self.opener, note)


def optimised(graph: ModelProto) -> ModelProto:
    """Return the graph after the optimisations that hold on any processor."""
    from backends.ort import executed_graph

    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "plain.onnx"
        plain.write_bytes(graph.SerializeToString())
        return executed_graph(plain, "extended")
