"""Parameters, bytes, multiply-accumulates and kernels, counted from the file."""

from __future__ import annotations

import pytest

from backends.cost import graph_cost
from backends.trees import nodes_passed

# one layer after another: outputs x inputs each looks at
REMNET_BLOCKS = sum(
    16 * width * 16 * 3 + 2 * 16 * 2 + 16 * (width // 2) * 16 * (3 + 1) for width in (128, 64, 32)
)
REMNET_MACS = 16 * 128 * 7 + REMNET_BLOCKS + 256
CNN_MACS = 10 * 149 * 4 + 20 * 75 * 10 * 5 + 20 * 34 * 20 * 4 + 40 * 17 * 20 * 4 + 320 * 128 + 128


@pytest.mark.parametrize("backend", ["fp32", "graph", "fp16"])
@pytest.mark.parametrize(
    ("model", "parameters", "macs"),
    [
        ("remnet", 6151, REMNET_MACS),
        ("cnn1d", 47147, CNN_MACS),
        ("mlp", 4673, 6 * 64 + 64 * 64 + 64),
    ],
)
def test_parameters_and_macs_are_those_of_the_paper_and_pencil(
    model: str, parameters: int, macs: int, backend: str, built
) -> None:
    cost = graph_cost(built(model, backend).path)
    assert (cost.parameters, cost.macs) == (parameters, macs)


def test_a_kernel_machine_counts_its_support_vectors(fitted, built) -> None:
    vectors = fitted("svm").module_.network.total.in_features
    cost = graph_cost(built("svm", "fp32").path)
    assert cost.parameters == vectors * 6 + vectors + 1
    assert cost.macs == vectors
    assert graph_cost(built("svm", "fp16").path).parameters == cost.parameters


def test_no_model_costs_nothing(built) -> None:
    cost = graph_cost(built("none", "fp32").path)
    assert (cost.parameters, cost.weight_bytes, cost.macs) == (0, 0, 0)


def test_layers_have_kinds_outputs_and_types(built) -> None:
    plain, fused, halves = (
        graph_cost(built("remnet", name).path) for name in ("fp32", "graph", "fp16")
    )
    convolutions = [layer for layer in plain.layers if layer.kind == "conv"]
    assert [layer.outputs for layer in convolutions[:3]] == [16 * 128, 16 * 128, 16 * 64]
    assert sum(layer.kind == "dense" for layer in plain.layers) == 7
    assert {layer.dtype for layer in plain.layers} == {"fp32"}
    assert {layer.dtype for layer in halves.layers if layer.macs} == {"fp16"}
    assert plain.kernels - fused.kernels == 16  # a ReLU in ten convolutions, six after dense


def test_what_a_row_holds_and_layers_read() -> None:
    """Two trees, of three and of one leaf: (2 + 3 + 3) / 3 nodes on the way, and 1."""
    from onnx import helper

    branch, leaf = "BRANCH_LEQ", "LEAF"
    node = helper.make_node(
        "TreeEnsembleRegressor",
        ["x"],
        ["y"],
        nodes_treeids=[0, 0, 0, 0, 0, 1],
        nodes_nodeids=[0, 1, 2, 3, 4, 0],
        nodes_modes=[branch, leaf, branch, leaf, leaf, leaf],
        nodes_truenodeids=[1, 0, 3, 0, 0, 0],
        nodes_falsenodeids=[2, 0, 4, 0, 0, 0],
    )
    assert nodes_passed(node) == round(8 / 3 + 1)


def test_kinds_inputs_and_reads(built) -> None:
    cost = graph_cost(built("remnet", "fp32").path)
    assert cost.inputs == 157
    kinds = {layer.operator: layer.kind for layer in cost.layers}
    assert (kinds["Relu"], kinds["Sigmoid"], kinds["Add"]) == (
        *("activation", "function", "elementwise"),
    )
    means = [layer for layer in cost.layers if layer.kind == "reduce"]
    assert [layer.reads for layer in means] == [16 * 128, 16 * 64, 16 * 32]
