"""8-bit integers as C, compiled for this machine."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from backends.base import Artifact, Backend, CannotTakeError, Precision, TrainingData
from backends.int8 import Int8Backend
from backends.qat import QatBackend

if TYPE_CHECKING:
    from zoo.base import MitigationModel, Progress


class CInt8Backend(Backend):
    """8-bit C99 of the graph that ONNX Runtime executes for `int8`, compiled for this processor.

    Sums are rounded as the runtime rounds them on x86, so predictions are the same bit by bit but
    for sums of floats before the first 8-bit layer.
    """

    name: ClassVar[str] = "c-int8"
    exports_as: ClassVar[str | None] = "int8"
    precision: ClassVar[Precision] = "int8"
    opener: ClassVar[str] = "backends.c.run:open_integer"
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is trained
    source: ClassVar[type[Backend]] = Int8Backend

    def supports(self, model: MitigationModel) -> str | None:
        """Return what to install where there is no C compiler, the source's reason, or None."""
        from backends.c.compile import missing_compiler

        return missing_compiler() or self.source().supports(model)

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the quantised graph to `path`; CannotTakeError where C cannot be written for it."""
        from backends.c.emit import generate
        from backends.c.fp32 import c_note

        built = self.source().build(model, data, path, progress)
        try:
            source = generate(path, "int8")
        except ValueError as problem:
            said = str(problem).replace(f"{path}: ", "")
            raise CannotTakeError(f"{type(model).__name__}: {said}") from None
        return replace(
            built, opener=self.opener, note=f"{built.note}; {c_note(source.arena_bytes)}"
        )


class CQatBackend(CInt8Backend):
    """8-bit C99 of the graph that ONNX Runtime executes for `qat`, compiled for this processor."""

    name: ClassVar[str] = "c-qat"
    exports_as: ClassVar[str | None] = "qat"
    bits_depend_on_threads: ClassVar[bool] = True
    source: ClassVar[type[Backend]] = QatBackend
