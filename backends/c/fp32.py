"""float32 as C, compiled for this machine."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from backends.base import Artifact, Backend, Precision, TrainingData

if TYPE_CHECKING:
    from zoo.base import MitigationModel, Progress


class CFp32Backend(Backend):
    """float32 C99, the source `bench export` writes, compiled for this processor.

    The file is the plain ONNX graph; C is written from it and compiled when it is opened, so a
    result folder holds nothing that could run by itself.
    """

    name: ClassVar[str] = "c-fp32"
    exports_as: ClassVar[str | None] = "fp32"
    precision: ClassVar[Precision] = "fp32"
    opener: ClassVar[str] = "backends.c.run:open_float"
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is trained

    def supports(self, model: MitigationModel) -> str | None:
        """Return what to install where there is no C compiler, or why there is no C for it."""
        from backends.c.compile import missing_compiler
        from backends.c.refusal import why_no_c

        return missing_compiler() or why_no_c(model)

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the exported graph to `path`; ValueError where C cannot be written for it."""
        from backends.c.emit import generate
        from backends.export import export_module
        from backends.graph_file import save_graph

        save_graph(export_module(model.to_module(), data.cirs.shape[1]), path)
        note = c_note(generate(path, "fp32").arena_bytes)
        return Artifact(path, self.precision, self.opener, note)


def c_note(arena_bytes: int) -> str:
    """Return what a C backend did, in words."""
    return f"C99 compiled when opened; {arena_bytes} bytes of memory for activations"
