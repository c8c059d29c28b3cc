"""Files that are no models, or worse, are refused by the reader in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from onnx import TensorProto, helper
from onnx_models import model_of, saved

from backends.c.emit import generate

ONE = np.array([1], np.int64)


def _refused(model, tmp_path: Path, text: str, precision: str = "fp32") -> None:
    path = saved(model, tmp_path)
    with pytest.raises(ValueError, match=text) as told:
        generate(path, precision)
    assert str(path) in str(told.value)
    assert "\n" not in str(told.value)
    assert [one.name for one in tmp_path.iterdir()] == ["model.onnx"]


@pytest.mark.parametrize("precision", ["fp32", "int8"])
def test_a_cycle(precision, tmp_path: Path) -> None:
    nodes = [helper.make_node("Add", ["x", "b"], ["a"]), helper.make_node("Relu", ["a"], ["b"])]
    _refused(model_of(nodes, [("x", 4)], output="b"), tmp_path, "cycle", precision)


def test_an_operator_that_is_not_known_is_named(tmp_path: Path) -> None:
    nodes = [helper.make_node("LSTM", ["x"], ["y"])]
    _refused(model_of(nodes, [("x", 4)]), tmp_path, "operator 'LSTM' is not one")


def test_a_graph_within_a_graph(tmp_path: Path) -> None:
    inner = model_of([helper.make_node("Relu", ["x"], ["y"])], [("x", 4)]).graph
    nodes = [helper.make_node("If", ["x"], ["y"], then_branch=inner, else_branch=inner)]
    _refused(model_of(nodes, [("x", 4)]), tmp_path, "operator 'If'")


@pytest.mark.parametrize("precision", ["fp32", "int8"])
def test_shapes_beyond_all_measure(precision, tmp_path: Path) -> None:
    nodes = [helper.make_node("Relu", ["x"], ["y"])]
    _refused(model_of(nodes, [("x", 1 << 40)]), tmp_path, "at most 1048576", precision)


def test_an_expansion_beyond_all_measure(tmp_path: Path) -> None:
    nodes = [helper.make_node("Expand", ["x", "to"], ["y"])]
    huge = [("to", np.array([1 << 30, 1 << 30, 4], np.int64))]
    _refused(model_of(nodes, [("x", 4)], huge), tmp_path, "at most 1048576")


@pytest.mark.parametrize("precision", ["fp32", "int8"])
def test_constants_that_claim_more_than_they_hold(precision, tmp_path: Path) -> None:
    model = model_of([helper.make_node("Add", ["x", "c"], ["y"])], [("x", 4)], [("c", ONE)])
    model.graph.initializer[0].dims[:] = [1000]
    _refused(model, tmp_path, "reshape", precision)


@pytest.mark.parametrize("precision", ["fp32", "int8"])
def test_weights_in_other_files(precision, tmp_path: Path) -> None:
    tensor = helper.make_tensor("c", TensorProto.FLOAT, [1], [1.0])
    tensor.data_location = TensorProto.EXTERNAL
    entry = tensor.external_data.add()
    entry.key, entry.value = "location", "/etc/passwd"
    nodes = [
        helper.make_node("Constant", [], ["c"], value=tensor),
        helper.make_node("Add", ["x", "c"], ["y"]),
    ]
    _refused(model_of(nodes, [("x", 1)]), tmp_path, "other files", precision)


def test_no_single_number_as_the_result(tmp_path: Path) -> None:
    nodes = [helper.make_node("Relu", ["x"], ["y"])]
    _refused(model_of(nodes, [("x", 4)]), tmp_path, "expected one number a row")


def test_a_value_made_twice(tmp_path: Path) -> None:
    nodes = [helper.make_node("Relu", ["x"], ["y"]), helper.make_node("Abs", ["x"], ["y"])]
    _refused(model_of(nodes, [("x", 1)]), tmp_path, "made twice")


def test_a_malformed_node(tmp_path: Path) -> None:
    nodes = [helper.make_node("Add", ["x"], ["y"])]
    _refused(model_of(nodes, [("x", 1)]), tmp_path, "Add of 1 values")
    nodes = [helper.make_node("Transpose", ["x"], ["y"], perm=[0, 0])]
    _refused(model_of(nodes, [("x", 1)]), tmp_path, "Transpose")


def test_a_name_that_is_code_stays_a_name(tmp_path: Path) -> None:
    evil = 'x; system("rm"); /*'
    nodes = [helper.make_node("Relu", [evil], ["y"])]
    source = generate(saved(model_of(nodes, [(evil, 1)]), tmp_path), "fp32")
    assert "system(" not in "".join(source.files.values())


@pytest.mark.parametrize("groups", [0, 2, 3])
def test_groups_that_do_not_suit_the_channels(groups: int, tmp_path: Path) -> None:
    weight = np.ones((4, 1, 3), np.float32)
    nodes = [
        helper.make_node("Unsqueeze", ["x", "one"], ["a"]),
        helper.make_node("Conv", ["a", "w"], ["c"], group=groups),
        helper.make_node("ReduceSum", ["c"], ["y"], keepdims=0),
    ]
    tensors = [("w", weight), ("one", np.array([1], np.int64))]
    path = saved(model_of(nodes, [("x", 9)], tensors), tmp_path)
    with pytest.raises(ValueError, match="groups"):
        generate(path, "fp32")
