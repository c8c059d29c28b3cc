"""Models of several inputs: one graph with named inputs on every backend, or the reason."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import onnx
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "zoo"))
from blocks import CIR, made_up_blocks

from backends.base import TrainingData
from backends.cost import graph_cost
from backends.fp16 import Fp16Backend
from backends.fp32 import Fp32Backend
from backends.graph import GraphBackend
from backends.int8 import Int8Backend
from backends.qat import QatBackend
from zoo import Constant, ConstantByLevel, GradientBoosting, MitigationModel

X, Y, LINKS = made_up_blocks(300, seed=1)
TEST = made_up_blocks(200, seed=2)[0]
LOSSLESS = (Fp32Backend(), GraphBackend())
QUANTISED = (Fp16Backend(), Int8Backend(), QatBackend())
FLOORS = [(Constant(), slice(CIR + 8, None)), (ConstantByLevel(), slice(CIR, CIR + 8))]
BOOSTED = (GradientBoosting(trees=20), slice(None))


@pytest.mark.parametrize("backend", LOSSLESS, ids=lambda one: one.name)
@pytest.mark.parametrize(("model", "columns"), [*FLOORS, BOOSTED])
def test_the_graph_gives_the_models_errors(
    model: MitigationModel, columns: slice, backend, tmp_path: Path
) -> None:
    fitted = model.fit(X[:, columns], Y)
    data = TrainingData(X[:, columns], Y, seed=0)
    artifact = backend.build(fitted, data, tmp_path / "model.onnx")
    difference = np.abs(artifact.predict(TEST[:, columns]) - fitted.predict(TEST[:, columns]))
    # a figure that differs in its last bit may fall on the other side of a tree's threshold
    assert (difference > 1e-5).mean() <= 0.01
    for batch in (1, 4):
        assert artifact.open()(TEST[:batch, columns]).shape == (batch,)


def test_inputs_carry_the_names_of_the_blocks(tmp_path: Path) -> None:
    model, columns = BOOSTED
    data = TrainingData(X[:, columns], Y, seed=0)
    artifact = Fp32Backend().build(model.fit(X, Y), data, tmp_path / "model.onnx")
    graph = onnx.load(artifact.path).graph
    widths = {one.name: one.type.tensor_type.shape.dim[1].dim_value for one in graph.input}
    assert widths == {"cir": CIR, "levels": 8, "range": 1}
    assert [one.name for one in graph.output] == ["error_m"]
    assert any(node.op_type == "TreeEnsembleRegressor" for node in graph.node)
    cost = graph_cost(artifact.path)
    [trees] = [node for node in graph.node if node.op_type == "TreeEnsembleRegressor"]
    leaves = next(one for one in trees.attribute if one.name == "target_weights").floats
    assert cost.parameters == 3 * len(leaves) - 20  # a tree of k leaves has 2 k - 1 nodes
    with pytest.raises(ValueError, match="rows have 5 columns, the graph takes 166"):
        artifact.open()(TEST[:, :5])


@pytest.mark.parametrize("backend", QUANTISED, ids=lambda one: one.name)
def test_what_has_no_smaller_form_is_skipped_with_the_reason(backend) -> None:
    for model, columns in FLOORS:
        fitted = model.fit(X[:, columns], Y)
        assert backend.supports(fitted) == f"{type(model).__name__} has no weights"
    model, _ = BOOSTED
    assert "made of trees" in str(backend.supports(model.fit(X, Y)))
