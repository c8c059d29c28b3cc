"""8-bit integers: weights, activations and the kernels that work on them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from backends.base import Artifact, Backend, Floats, Precision, TrainingData
from backends.weights import no_weights

if TYPE_CHECKING:
    from onnx import ModelProto

    from backends.quantise import Range
    from zoo.base import MitigationModel, Progress


OPENER = "backends.ort:open_optimised"


class Int8Backend(Backend):
    """ONNX Runtime with static 8-bit quantisation, calibrated on training rows.

    Activations are unsigned 8 bit, weights signed 8 bit with a scale per output channel. What
    prepares the input (normalisation, hand-crafted features) and the final result stay float32.
    """

    name: ClassVar[str] = "int8"
    precision: ClassVar[Precision] = "int8"
    opener: ClassVar[str] = OPENER
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is trained

    def supports(self, model: MitigationModel) -> str | None:
        """Return the reason why the model cannot be quantised, or None."""
        return no_weights(model)

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the quantised graph to `path`; ranges come from a sample of the training rows."""
        from backends.export import exported
        from backends.integer_form import to_integer_form
        from backends.sample import sample_rows

        graph = exported(model.to_module(), data.cirs.shape[1], to_integer_form).graph
        rows = sample_rows(data)
        return write_artifact(graph, rows, path, f"ranges from {len(rows)} training rows")


def write_artifact(
    graph: ModelProto,
    rows: Floats,
    path: Path,
    how: str,
    learnt: Mapping[str, Range] | None = None,
) -> Artifact:
    """Quantise a float graph as `backends.quantise.quantise` does and write it to `path`."""
    from backends.graph_file import save_graph
    from backends.ort import kernel_coverage
    from backends.quantise import quantise
    from backends.quantised_file import trim

    quantised = quantise(graph, rows, learnt).model
    trim(quantised)
    save_graph(quantised, path)
    coverage = kernel_coverage(path)
    note = f"{coverage.integer} of {coverage.total} layers in 8-bit integers; {how}"
    return Artifact(path, "int8", OPENER, note, coverage)
