"""The reference: float32, every operator as exported."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from backends.base import Artifact, Backend, Precision, TrainingData

if TYPE_CHECKING:
    from zoo.base import MitigationModel, Progress


class Fp32Backend(Backend):
    """ONNX Runtime in float32 with graph optimisation off: what every speed-up is against."""

    name: ClassVar[str] = "fp32"
    precision: ClassVar[Precision] = "fp32"
    opener: ClassVar[str] = "backends.ort:open_plain"
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is trained

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the exported graph to `path`; it is run operator by operator."""
        from backends.export import export_module
        from backends.graph_file import save_graph

        save_graph(export_module(model.to_module(), data.cirs.shape[1]), path)
        note = "graph optimisation off"
        return Artifact(path, self.precision, self.opener, note)
