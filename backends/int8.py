"""8-bit integers: weights, activations and the kernels that work on them."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from backends.base import Artifact, Backend, Precision, TrainingData
from backends.weights import no_weights
from zoo.base import MitigationModel, Progress


class Int8Backend(Backend):
    """ONNX Runtime with static 8-bit quantisation, calibrated on training rows.

    Activations are unsigned 8 bit, weights signed 8 bit with a scale per output channel. What
    prepares the input (normalisation, hand-crafted features) and the final result stay float32.
    """

    name: ClassVar[str] = "int8"
    precision: ClassVar[Precision] = "int8"

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
        from backends.export import export_module
        from backends.graph_file import save_graph
        from backends.integer_form import integer_form
        from backends.ort import kernel_coverage
        from backends.quantise import quantise
        from backends.quantised_file import trim
        from backends.sample import sample_rows

        width = data.cirs.shape[1]
        graph = export_module(integer_form(model.to_module(), width), width)
        rows = sample_rows(data)
        quantised = quantise(graph, rows)
        trim(quantised)
        save_graph(quantised, path)
        coverage = kernel_coverage(path)
        note = (
            f"{coverage.integer} of {coverage.total} layers in 8-bit integers; "
            f"ranges from {len(rows)} training rows"
        )
        return Artifact(path, self.precision, "backends.ort:open_optimised", note, coverage)
