"""Weights stored in 16 bits, computed in 32."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, TensorProto, helper, numpy_helper

from backends.base import Artifact, Backend, Floats, Precision, TrainingData
from backends.cost import row_values
from backends.weights import no_weights, weight_names
from zoo.base import MitigationModel, Progress

FEWEST_VALUES = 16  # below this, the operator that widens them again costs more than it saves


LIMIT_M = 9e-4  # below the 1 mm that is promised, as other rows may be moved a little more


class Fp16Backend(Backend):
    """Weights stored as float16; the processor computes in float32.

    ONNX Runtime's processor kernels have no float16 arithmetic: it would convert every value
    before and after each operator. So this is weight storage, and says so. Inputs, outputs and
    everything between stay float32, as features such as the energy (1e9) exceed float16. So do
    weights whose rounding would move predictions too far, such as support vectors.
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
        """Write the graph with its weights in float16 to `path`.

        Weights are taken in order of harm, as long as the largest shifts that they cause on a
        sample of training rows add up to less than `LIMIT_M`.
        """
        from backends.export import export_module
        from backends.graph_file import save_graph
        from backends.sample import sample_rows

        graph = export_module(model.to_module(), data.cirs.shape[1])
        shifts = rounding_shifts_m(graph, sample_rows(data))
        chosen = _within(shifts, LIMIT_M)
        store_as_halves(graph, chosen)
        save_graph(graph, path)
        return Artifact(path, self.precision, "backends.ort:open_optimised", _note(shifts, chosen))


def _note(shifts: dict[str, float], chosen: set[str]) -> str:
    note = "weights stored as float16, computed in float32"
    kept = len(shifts) - len(chosen)
    return note if not kept else f"{note}; {kept} of {len(shifts)} kept as float32 for accuracy"


def rounding_shifts_m(model: ModelProto, cirs: Floats) -> dict[str, float]:
    """Return how far rounding each weight alone to float16 moves a prediction at most, in metres.

    Left out are weights of fewer than `FEWEST_VALUES` and those outside float16's range.
    """
    from backends.ort import run_once

    before = run_once(model, cirs)[0]
    weights, shifts = weight_names(model.graph, row_values(model)), {}
    for tensor in model.graph.initializer:
        if tensor.name in weights and _fits_half(tensor):
            exact = numpy_helper.to_array(tensor).copy()
            _set(tensor, exact.astype(np.float16).astype(np.float32))
            shifts[tensor.name] = float(np.abs(run_once(model, cirs)[0] - before).max())
            _set(tensor, exact)
    return shifts


def _within(shifts: dict[str, float], limit_m: float) -> set[str]:
    """Return as many names as possible whose shifts add up to no more than the limit."""
    names = sorted(shifts, key=shifts.__getitem__)
    totals = np.cumsum([shifts[name] for name in names])
    return {name for name, total in zip(names, totals, strict=True) if total <= limit_m}


def store_as_halves(model: ModelProto, chosen: set[str]) -> None:
    """Replace the chosen weights by their float16 values and a cast that widens them on loading."""
    graph, casts = model.graph, []
    for tensor in graph.initializer:
        if tensor.name in chosen:
            casts.append(helper.make_node("Cast", [f"{tensor.name}_half"], [tensor.name], to=1))
            _set(tensor, numpy_helper.to_array(tensor).astype(np.float16))
            tensor.name = f"{tensor.name}_half"
    nodes = [*casts, *graph.node]
    del graph.node[:]
    graph.node.extend(nodes)


def _fits_half(tensor: TensorProto) -> bool:
    """Tell whether these are weights of some size that float16 holds to its full 11 bits."""
    values = numpy_helper.to_array(tensor)
    if values.dtype != np.float32 or values.size < FEWEST_VALUES:
        return False
    largest, limits = np.abs(values).max(), np.finfo(np.float16)
    return bool(limits.smallest_normal < largest <= limits.max)


def _set(tensor: TensorProto, values: NDArray[Any]) -> None:
    tensor.CopyFrom(numpy_helper.from_array(values, tensor.name))
