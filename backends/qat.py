"""8-bit integers, with weights and ranges trained for them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from backends.base import Artifact, Backend, Precision, TrainingData
from backends.int8 import OPENER, write_artifact
from backends.weights import no_weights

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from onnx import ModelProto

    from backends.export import Exported
    from backends.quantise import Range
    from zoo.base import MitigationModel, Progress, TrainingRecipe

EPOCHS = 4
BATCH_ROWS = 256
MOST_STEPS = 300  # a falling rate has settled by then: on many rows fewer passes are as good

KEPT = 32
_LEARNT: dict[str, Learnt] = {}
"""By digest, the last `KEPT`: C and the runtime are given the same weights, trained once."""


class QatBackend(Backend):
    """ONNX Runtime with 8-bit quantisation that the weights were trained for.

    Training goes on from the fitted weights with every value rounded exactly where the `int8`
    graph rounds it, activations after the ReLU that their layer swallows. Weights and ranges
    learn; then the same quantisation as `int8` is done with the learnt ranges. So `qat` differs
    from `int8` in weights and ranges alone.

    The model's own recipe is followed but for three things: `EPOCHS` passes are enough from a
    fitted start, or as many as `MOST_STEPS` make (one at least); batches are at least `BATCH_ROWS`
    to keep it short; and the learning rate falls from the recipe's to 0, so that weights settle.
    Dropout is off.
    """

    name: ClassVar[str] = "qat"
    precision: ClassVar[Precision] = "int8"
    opener: ClassVar[str] = OPENER

    def supports(self, model: MitigationModel) -> str | None:
        """Return the reason why the model cannot be trained further, or None."""
        if reason := no_weights(model):
            return reason
        if model.training_recipe() is None:
            return f"{type(model).__name__} is not trained by gradient descent"
        return None

    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Train further on the training rows, then write the quantised graph to `path`.

        Raises ValueError for a model without a training recipe.
        """
        from backends.export import exported
        from backends.integer_form import to_integer_form
        from backends.sample import sample_rows

        recipe = model.training_recipe()
        if recipe is None:
            raise ValueError(str(self.supports(model)))
        form = exported(model.to_module(), data.cirs.shape[1], to_integer_form)
        learnt = _learnt_once(form, recipe, data, progress)
        count = passes(len(data.cirs), recipe.batch_size)
        epochs = f"{count} epoch{'s' * (count > 1)}"
        how = f"trained {epochs} further with rounded weights and activations"
        return write_artifact(learnt.graph, sample_rows(data), path, how, learnt.ranges)


def passes(rows: int, batch_rows: int) -> int:
    """Return how many passes over so many rows are made, in batches of at least `BATCH_ROWS`."""
    steps = -(-rows // max(batch_rows, BATCH_ROWS))
    return max(1, min(EPOCHS, MOST_STEPS // max(steps, 1)))


@dataclass(frozen=True)
class Learnt:
    """A float graph with the trained weights, and the ranges to quantise it with, by value."""

    graph: ModelProto
    ranges: Mapping[str, Range]


def _learnt_once(
    form: Exported, recipe: TrainingRecipe, data: TrainingData, progress: Progress | None
) -> Learnt:
    """Train once for all the backends that write the same 8-bit weights."""
    asked = _digest(form, recipe, data)
    if asked not in _LEARNT:
        learnt = train_quantised(form, recipe, data, progress)
        if len(_LEARNT) >= KEPT:
            del _LEARNT[next(iter(_LEARNT))]
        _LEARNT[asked] = learnt
    return _LEARNT[asked]


def _digest(form: Exported, recipe: TrainingRecipe, data: TrainingData) -> str:
    """Return a hash of all that decides the training."""
    found = hashlib.sha256(form.graph.SerializeToString(deterministic=True))
    found.update(repr((recipe, data.seed, data.cirs.shape, data.cirs.dtype)).encode())
    for values in (data.cirs, data.errors_m):
        found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()


def train_quantised(
    form: Exported,
    recipe: TrainingRecipe,
    data: TrainingData,
    progress: Progress | None = None,
) -> Learnt:
    """Return weights and ranges after training with rounding, from those of calibration on."""
    from backends.fake_quant import Fed, fake_quantised, learnt_ranges
    from backends.inputs import graph_inputs
    from backends.quantise import quantise
    from backends.sample import sample_rows
    from zoo.training.eager import train

    start = quantise(form.graph, sample_rows(data)).ranges
    rounded = fake_quantised(form.module(), start)
    whole = Fed(rounded, graph_inputs(form.graph))
    further = replace(
        recipe,
        batch_size=max(recipe.batch_size, BATCH_ROWS),
        epochs=passes(len(data.cirs), recipe.batch_size),
        seed=data.seed,
        stopping=None,
        decay=True,
    )
    train(whole, data.cirs, data.errors_m, further, progress=progress)
    weights = {name: value.detach().numpy() for name, value in rounded.named_parameters()}
    return Learnt(with_weights(form.graph, weights), learnt_ranges(rounded))


def with_weights(graph: ModelProto, weights: Mapping[str, NDArray[Any]]) -> ModelProto:
    """Return a copy of the graph with other values for the constants of these names."""
    from onnx import ModelProto, numpy_helper

    copy = ModelProto()
    copy.CopyFrom(graph)
    for tensor in copy.graph.initializer:
        if tensor.name in weights:
            tensor.CopyFrom(numpy_helper.from_array(weights[tensor.name], tensor.name))
    return copy
