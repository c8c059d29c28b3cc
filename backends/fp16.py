"""Weights stored in 16 bits, computed in 32."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from onnx import ModelProto, TensorProto, helper, numpy_helper

from backends.base import Artifact, Backend, Floats, Precision, TrainingData
from backends.cost import row_values
from backends.weights import no_weights, weight_names

if TYPE_CHECKING:
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
    opener: ClassVar[str] = "backends.ort:open_optimised"
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is trained

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

        Where rounding all weights moves a prediction on a sample of training rows by more than
        `LIMIT_M`, those that harm most stay float32.
        """
        from backends.export import export_module
        from backends.graph_file import save_graph
        from backends.sample import sample_rows

        graph = export_module(model.to_module(), data.cirs.shape[1])
        names = narrowable(graph)
        chosen = harmless(graph, names, sample_rows(data))
        store_as_halves(graph, chosen)
        save_graph(graph, path)
        note = _note(len(names), len(chosen))
        return Artifact(path, self.precision, self.opener, note)


def _note(weights: int, stored: int) -> str:
    note = "weights stored as float16, computed in float32"
    kept = weights - stored
    return note if not kept else f"{note}; {kept} of {weights} kept as float32 for accuracy"


def narrowable(model: ModelProto) -> list[str]:
    """Return the weights of at least `FEWEST_VALUES` that lie within float16's range."""
    weights = weight_names(model.graph, row_values(model))
    return [t.name for t in model.graph.initializer if t.name in weights and _fits_half(t)]


def harmless(model: ModelProto, names: list[str], cirs: Floats) -> set[str]:
    """Return as many weights as float16 may hold with no prediction moved beyond `LIMIT_M`.

    They are taken in the order of how far each moves a prediction alone.
    """
    if shift_m(model, names, cirs) <= LIMIT_M:
        return set(names)
    alone = {name: shift_m(model, [name], cirs) for name in names}
    order = sorted(names, key=alone.__getitem__)
    while order and shift_m(model, order, cirs) > LIMIT_M:
        order.pop()
    return set(order)


def shift_m(model: ModelProto, names: list[str], cirs: Floats) -> float:
    """Return how far float16 values of these weights move a prediction at most, in metres."""
    from backends.ort import run_once

    rounded = ModelProto()
    rounded.CopyFrom(model)
    for tensor in rounded.graph.initializer:
        if tensor.name in names:
            halves = numpy_helper.to_array(tensor).astype(np.float16)
            _set(tensor, halves.astype(np.float32))
    moved = run_once(rounded, cirs)[0] - run_once(model, cirs)[0]
    return float(np.abs(moved).max())


def store_as_halves(model: ModelProto, chosen: Collection[str]) -> None:
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
