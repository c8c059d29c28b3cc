"""8-bit integers: which kernels run, how far results move, how small the file is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
import pytest
import torch
from onnx import numpy_helper
from torch import nn

from backends.base import Floats, TrainingData
from backends.cost import graph_cost
from backends.export import exported
from backends.graph_file import load_graph
from backends.int8 import Int8Backend
from backends.integer_form import to_integer_form
from backends.ort import executed_graph, kernel_coverage
from backends.quantise import Range, quantise

INTEGER = {"QLinearConv", "QGemm", "QLinearMatMul", "MatMulInteger"}
FLOAT = {"Conv", "FusedConv", "Gemm", "FusedGemm", "MatMul", "FusedMatMul"}


def test_every_convolution_and_dense_layer_of_remnet_runs_on_integers(built) -> None:
    artifact = built("remnet", "int8")
    operators = [node.op_type for node in executed_graph(artifact.path).graph.node]
    assert sum(operator in INTEGER for operator in operators) == 17  # 10 convolutions, 7 dense
    assert not FLOAT & set(operators)
    assert not {"Relu", "Add", "Mul", "Sigmoid"} & set(operators)
    assert operators.count("QuantizeLinear") == 1
    assert "DequantizeLinear" not in operators
    assert (artifact.coverage.integer, artifact.coverage.total) == (17, 17)
    assert artifact.note.startswith("17 of 17 layers in 8-bit integers")


@pytest.mark.parametrize(("model", "layers"), [("cnn1d", 6), ("mlp", 3), ("svm", 1)])
def test_every_layer_of_the_others_too(model: str, layers: int, built) -> None:
    coverage = kernel_coverage(built(model, "int8").path)
    assert (coverage.integer, coverage.total) == (layers, layers)


def test_weights_are_signed_and_activations_unsigned(built) -> None:
    graph = load_graph(built("remnet", "int8").path).graph
    types = {tensor.name: tensor.data_type for tensor in graph.initializer}
    for node in graph.node:
        if node.op_type == "QuantizeLinear":
            assert types[node.input[2]] == onnx.TensorProto.UINT8
        if node.op_type in ("Conv", "Gemm"):
            [widen] = [other for other in graph.node if node.input[1] in other.output]
            assert types[widen.input[0]] == onnx.TensorProto.INT8


def test_every_weight_has_a_zero_point_of_its_own(built) -> None:
    """A runtime that adds without overflow makes weights unsigned, and replaces each by name."""
    graph = load_graph(built("remnet", "int8").path).graph
    signed = {t.name for t in graph.initializer if t.data_type == onnx.TensorProto.INT8}
    points = [n.input[2] for n in graph.node if n.op_type == "DequantizeLinear"]
    own = [one for one in points if one in signed]
    assert own
    assert len(own) == len(set(own))


@pytest.mark.parametrize("model", ["remnet", "cnn1d", "mlp"])
def test_file_is_at_most_0_6_of_float32(model: str, built) -> None:
    plain, small = (graph_cost(built(model, name).path) for name in ("fp32", "int8"))
    assert small.file_bytes <= 0.6 * plain.file_bytes
    assert small.weight_bytes < 0.35 * plain.weight_bytes
    assert (small.parameters, small.macs) == (plain.parameters, plain.macs)
    assert {layer.dtype for layer in small.layers if layer.macs} == {"int8"}


@pytest.mark.parametrize("model", ["remnet", "cnn1d", "mlp", "svm"])
def test_mean_absolute_error_moves_by_less_than_2_cm(
    model: str, built, test_rows: tuple[Floats, Floats]
) -> None:
    cirs, errors = test_rows
    plain, small = (built(model, name).predict(cirs) for name in ("fp32", "int8"))
    assert not np.array_equal(plain, small)
    change = np.abs(small - errors).mean() - np.abs(plain - errors).mean()
    assert abs(change) < 0.02


def test_result_is_not_rounded_to_8_bits(built, test_rows: tuple[Floats, Floats]) -> None:
    assert len(np.unique(built("remnet", "int8").predict(test_rows[0]))) > 300


def test_what_has_no_weights_is_skipped_with_the_reason(fitted) -> None:
    assert Int8Backend().supports(fitted("none")) == "NoMitigation has no weights"
    assert Int8Backend().supports(fitted("mlp")) is None


def test_same_seed_same_file(fitted, training: TrainingData, tmp_path: Path) -> None:
    many = TrainingData(training.cirs, training.errors_m, seed=5)
    other = TrainingData(training.cirs, training.errors_m, seed=6)
    files = []
    for index, data in enumerate((many, many, other)):
        artifact = Int8Backend().build(fitted("mlp"), data, tmp_path / f"{index}.onnx")
        files.append(artifact.path.read_bytes())
    assert files[0] == files[1] != files[2]


@pytest.mark.parametrize("model", ["remnet", "cnn1d", "mlp", "svm"])
def test_integer_form_is_the_same_function(
    model: str, fitted, test_rows: tuple[Floats, Floats]
) -> None:
    module, rows = fitted(model).to_module(), torch.from_numpy(test_rows[0])
    form = exported(module, 157, to_integer_form).module()
    with torch.no_grad():
        assert (form(rows) - module(rows)).abs().max() < 2e-6
    assert sum(p.numel() for p in form.parameters()) == sum(p.numel() for p in module.parameters())


class SharedGate(nn.Module):
    """One dense layer used by two gates: its weight must keep its shape."""

    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Conv1d(1, 4, 3, padding=1)
        self.dense, self.head = nn.Linear(4, 4), nn.Linear(4 * 112, 1)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        maps = torch.relu(self.first(x.unsqueeze(1)))
        for _ in range(2):
            maps = maps * torch.sigmoid(self.dense(maps.mean(-1))).unsqueeze(-1)
        return self.head(maps.flatten(1)).squeeze(1)


def test_integer_form_leaves_shared_weights_alone() -> None:
    torch.manual_seed(0)
    module, rows = SharedGate().eval(), torch.rand(5, 112)
    with torch.no_grad():
        assert (
            exported(module, 112, to_integer_form).module()(rows) - module(rows)
        ).abs().max() < 1e-6
    assert module.dense.weight.shape == (4, 4)


class DeadChannel(nn.Module):
    """A convolution with a channel of no weight but a bias, which 32 bits could not hold."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.head = nn.Conv1d(1, 3, 3), nn.Linear(3 * 10, 1)
        with torch.no_grad():
            self.first.weight[1], self.first.bias[1] = 1e-12, 0.7
            self.first.weight[2], self.first.bias[2] = 0.0, 0.3

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.head(torch.relu(self.first(x.unsqueeze(1))).flatten(1)).squeeze(1)


class Holder:
    """Stands in for a fitted model."""

    def __init__(self, module: nn.Module) -> None:
        self.module = module

    def to_module(self) -> nn.Module:
        return self.module.eval()


def test_a_dead_channel_keeps_its_bias(tmp_path: Path) -> None:
    torch.manual_seed(1)
    module, rows = DeadChannel(), np.random.default_rng(0).random((50, 12), dtype=np.float32)
    data = TrainingData(rows, rows[:, 0], 0)
    artifact = Int8Backend().build(Holder(module), data, tmp_path / "dead.onnx")
    expected = module(torch.from_numpy(rows)).detach().numpy()
    assert artifact.predict(rows) == pytest.approx(expected, abs=0.02)
    assert artifact.coverage.integer == artifact.coverage.total == 2


def test_learnt_ranges_are_used_as_given(fitted, training: TrainingData) -> None:
    graph = exported(fitted("mlp").to_module(), 157, to_integer_form).graph
    ranges = quantise(graph, training.cirs[:64]).ranges
    assert "relu" in ranges
    assert ranges["relu"].zero_point == 0  # a ReLU's output has nothing below
    learnt = ranges | {"relu": Range(0.125, 3)}
    assert quantise(graph, training.cirs[:64], learnt).ranges == learnt


def test_biases_are_stored_once_and_small(built) -> None:
    graph = load_graph(built("cnn1d", "int8").path).graph
    stored = {tensor.name: numpy_helper.to_array(tensor) for tensor in graph.initializer}
    biases = [stored.get(node.input[2]) for node in graph.node if node.op_type == "Conv"]
    assert [bias.shape for bias in biases] == [(10,), (20,), (20,), (40,)]
    assert {bias.dtype for bias in biases} == {np.dtype("float32")}
