"""What the files hold, and what happens with files that are not what they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from backends.cost import graph_cost
from backends.graph_file import compact, load_graph
from backends.ort import kernel_coverage, open_optimised, open_plain


def _tiny_model() -> onnx.ModelProto:
    """Two equal constants under long names, a default attribute, documentation, metadata."""
    weight = np.arange(6, dtype=np.float32).reshape(3, 2)
    nodes = [
        helper.make_node("Gemm", ["cir", "a.long.name"], ["first.value"], name="n", alpha=1.0),
        helper.make_node("Gemm", ["first.value", "another"], ["second"], transB=1),
        helper.make_node("ReduceSum", ["second", "axis"], ["error_m"], keepdims=0),
    ]
    graph = helper.make_graph(
        nodes,
        "a graph with a name",
        [helper.make_tensor_value_info("cir", TensorProto.FLOAT, ["n", 3])],
        [helper.make_tensor_value_info("error_m", TensorProto.FLOAT, ["n"])],
        [
            onnx.numpy_helper.from_array(weight, "a.long.name"),
            onnx.numpy_helper.from_array(weight, "another"),
            onnx.numpy_helper.from_array(np.array([1]), "axis"),
            onnx.numpy_helper.from_array(weight, "unused"),
        ],
        doc_string="words",
    )
    opsets = [helper.make_opsetid("", 20), helper.make_opsetid("ai.onnx.ml", 5)]
    return helper.make_model(graph, opset_imports=opsets, ir_version=10, producer_name="someone")


def _saved(model: onnx.ModelProto, path: Path) -> Path:
    path.write_bytes(model.SerializeToString())
    return path


def test_compact_keeps_the_values_and_drops_the_rest(tmp_path: Path) -> None:
    model, rows = _tiny_model(), np.ones((2, 3), np.float32)
    before = open_plain(_saved(model, tmp_path / "before.onnx"))(rows)
    compact(model)
    onnx.checker.check_model(model, full_check=True)
    after = open_plain(_saved(model, tmp_path / "after.onnx"))(rows)
    assert after.tolist() == before.tolist() == [117.0, 117.0]
    assert [tensor.name for tensor in model.graph.initializer] == ["0", "1"]
    assert [[entry.name for entry in node.attribute] for node in model.graph.node] == [
        [],
        ["transB"],
        ["keepdims"],
    ]
    assert [entry.domain for entry in model.opset_import] == [""]
    assert b"words" not in model.SerializeToString()


@pytest.mark.parametrize("model", ["remnet", "cnn1d"])
def test_fp32_file_is_little_more_than_its_weights(model: str, built) -> None:
    cost = graph_cost(built(model, "fp32").path)
    assert cost.weight_bytes == 4 * cost.parameters
    assert cost.file_bytes < cost.weight_bytes + 3000


@pytest.mark.parametrize("model", ["remnet", "cnn1d", "mlp"])
def test_fp16_file_takes_about_half(model: str, built) -> None:
    plain, halves = (graph_cost(built(model, name).path) for name in ("fp32", "fp16"))
    assert halves.parameters == plain.parameters
    assert halves.weight_bytes < 0.51 * plain.weight_bytes
    assert halves.file_bytes < 0.6 * plain.file_bytes


def test_saved_graph_is_already_fused_and_holds_nothing_of_this_machine(built) -> None:
    operators = {node.op_type for node in load_graph(built("remnet", "graph").path).graph.node}
    assert {"FusedConv", "FusedGemm"} <= operators
    assert "Relu" not in operators
    domains = {entry.domain for entry in load_graph(built("cnn1d", "graph").path).opset_import}
    assert domains == {"", "com.microsoft"}  # not com.microsoft.nchwc


def test_notes_say_what_was_done(built) -> None:
    assert "computed in float32" in built("remnet", "fp16").note
    assert built("remnet", "fp32").note == "graph optimisation off"


def test_float_graphs_have_no_integer_kernels(built) -> None:
    coverage = kernel_coverage(built("remnet", "fp32").path)
    assert (coverage.integer, coverage.total) == (0, 17)
    assert coverage.kernels["FusedConv"] == 10


def _truncated(path: Path, target: Path) -> Path:
    content = path.read_bytes()
    target.write_bytes(content[: len(content) // 2])
    return target


@pytest.mark.parametrize("reader", [load_graph, open_plain, open_optimised, graph_cost])
def test_a_broken_file_is_one_clear_error(reader, built, tmp_path: Path) -> None:
    bad = tmp_path / "bad.onnx"
    _truncated(built("mlp", "fp32").path, bad)
    with pytest.raises(ValueError, match=r"bad\.onnx"):
        reader(bad)
    for content in (b"", b"\x80\x04K\x01.", b"\x00" * 100, bytes(range(256)) * 40):
        bad.write_bytes(content)
        with pytest.raises(ValueError, match=r"bad\.onnx") as caught:
            reader(bad)
        assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match=r"gone\.onnx"):
        reader(tmp_path / "gone.onnx")


@pytest.mark.parametrize("reader", [load_graph, open_plain, graph_cost])
def test_weights_in_another_file_are_refused(reader, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "secret.bin").write_bytes(bytes(24))
    model = _tiny_model()
    tensor = model.graph.initializer[0]
    onnx.external_data_helper.set_external_data(tensor, "secret.bin", length=24)
    tensor.ClearField("raw_data")
    tensor.data_location = TensorProto.EXTERNAL
    with pytest.raises(ValueError, match=r"outside\.onnx"):
        reader(_saved(model, tmp_path / "outside.onnx"))


def test_an_operator_nobody_knows_is_refused(tmp_path: Path) -> None:
    model = _tiny_model()
    model.graph.node[0].op_type = "Gemmm"
    with pytest.raises(ValueError, match=r"odd\.onnx: refused by ONNX Runtime: .*Gemmm"):
        open_optimised(_saved(model, tmp_path / "odd.onnx"))


def test_rows_of_another_width_are_one_clear_error(built) -> None:
    run = built("mlp", "fp32").open()
    with pytest.raises(ValueError, match="invalid dimensions"):
        run(np.ones((2, 12), np.float32))
