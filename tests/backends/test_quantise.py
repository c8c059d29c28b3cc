"""The one quantising call on a network that can be checked by hand: no torch, no training."""

from __future__ import annotations

import numpy as np
import onnxruntime
import pytest
from onnx import ModelProto, TensorProto, helper, numpy_helper

from backends.quantise import Range, quantise

WIDTH = 12


def network(keepdims: int = 1, axis: int = -1) -> ModelProto:
    """Return x [n, 12] -> conv, relu, conv, relu, mean over time, dense -> y [n, 1]."""
    rng = np.random.default_rng(0)
    shapes = {"w0": (3, 1, 3), "w1": (4, 3, 3), "wd": (4, 1)}
    made = [numpy_helper.from_array(rng.normal(size=shape).astype(np.float32), name)
            for name, shape in shapes.items()]  # fmt: skip
    made += [numpy_helper.from_array(np.array([1]), "one"),
             numpy_helper.from_array(np.array([axis]), "axis")]  # fmt: skip
    nodes = [
        helper.make_node("Unsqueeze", ["x", "one"], ["h"]),
        helper.make_node("Conv", ["h", "w0"], ["c0"], pads=[1, 1]),
        helper.make_node("Relu", ["c0"], ["r0"]),
        helper.make_node("Conv", ["r0", "w1"], ["c1"], pads=[1, 1]),
        helper.make_node("Relu", ["c1"], ["r1"]),
        helper.make_node("ReduceMean", ["r1", "axis"], ["m"], keepdims=keepdims),
        helper.make_node("Flatten", ["m"], ["f"]),
        helper.make_node("Gemm", ["f", "wd"], ["y"]),
    ]
    ends = [helper.make_tensor_value_info("x", TensorProto.FLOAT, ["n", WIDTH])]
    result = [helper.make_tensor_value_info("y", TensorProto.FLOAT, ["n", 1])]
    graph = helper.make_graph(nodes, "small", ends, result, made)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=10)


def rows(count: int = 300, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).random((count, WIDTH)).astype(np.float32)


def run(model: ModelProto, x: np.ndarray) -> np.ndarray:
    """Return what the optimised graph gives where sums of bytes do not overflow."""
    options = onnxruntime.SessionOptions()
    options.add_session_config_entry("session.x64quantprecision", "1")
    session = onnxruntime.InferenceSession(
        model.SerializeToString(), options, providers=["CPUExecutionProvider"]
    )
    return session.run(None, {"x": x})[0]


def activations(x: np.ndarray, name: str) -> np.ndarray:
    """Return a value inside the float network."""
    model = network()
    model.graph.output.append(helper.make_tensor_value_info(name, TensorProto.FLOAT, None))
    session = onnxruntime.InferenceSession(
        model.SerializeToString(), providers=["CPUExecutionProvider"]
    )
    return session.run([name], {"x": x})[0]


@pytest.fixture(scope="module")
def done():
    return quantise(network(), rows())


def test_the_result_stays_within_a_hundredth_of_the_float_network(done) -> None:
    x = rows(50, seed=2)
    expected = run(network(), x)
    assert np.abs(run(done.model, x) - expected).max() < 0.01 * np.ptp(expected) + 0.02


def test_ranges_are_the_extremes_over_all_rows(done) -> None:
    x = rows()
    assert {"h", "r0", "r1"} <= set(done.ranges)
    for name in ("h", "r0", "r1"):
        value = activations(x, name)
        low, high = min(0.0, value.min()), max(0.0, value.max())
        found = done.ranges[name]
        assert found.scale == pytest.approx((high - low) / 255, rel=1e-4)
        assert found.zero_point == round(-low / found.scale)


def test_rows_beyond_the_first_block_count() -> None:
    x = rows()
    x[290] *= 50
    wide = quantise(network(), x).ranges["h"].scale
    assert wide == pytest.approx(x.max() / 255, rel=1e-4)


def test_a_relu_is_part_of_the_layer_before_it(done) -> None:
    assert not {"c0", "c1"} & set(done.ranges)


def test_the_result_is_float_and_what_prepares_the_input_too(done) -> None:
    markers = [node for node in done.model.graph.node if node.op_type == "QuantizeLinear"]
    values = {node.input[0] for node in markers}
    assert "y" not in values
    assert "x" not in values
    assert "y" not in done.ranges
    [dense] = [node for node in done.model.graph.node if node.op_type == "Gemm"]
    assert dense.output[0] == done.model.graph.output[0].name
    assert done.model.graph.output[0].type.tensor_type.elem_type == TensorProto.FLOAT


def test_weights_are_signed_with_a_scale_per_channel_and_activations_unsigned(done) -> None:
    tensors = {t.name: numpy_helper.to_array(t) for t in done.model.graph.initializer}
    weights = [v for v in tensors.values() if v.dtype == np.int8 and v.ndim > 1]
    assert {v.shape for v in weights} == {(3, 1, 3), (4, 3, 3), (4, 1)}
    assert all(np.abs(v.astype(int)).max() >= 126 for v in weights)
    for node in done.model.graph.node:
        if node.op_type == "QuantizeLinear":
            assert tensors[node.input[2]].dtype == np.uint8
    convolutions = [n for n in done.model.graph.node if n.op_type == "Conv"]
    makers = {n.output[0]: n for n in done.model.graph.node}
    for node, channels in zip(convolutions, (3, 4), strict=True):
        assert tensors[makers[node.input[1]].input[1]].shape == (channels,)


def test_a_mean_over_time_becomes_the_pooling_with_an_integer_kernel(done) -> None:
    kinds = [node.op_type for node in done.model.graph.node]
    assert "GlobalAveragePool" in kinds
    assert "ReduceMean" not in kinds


@pytest.mark.parametrize(
    ("keepdims", "axis", "pooled"), [(0, -1, False), (1, 1, False), (1, 2, True)]
)
def test_only_a_mean_over_the_last_axis_that_stays_is_pooled(keepdims, axis, pooled) -> None:
    if axis == 1:  # the mean over channels leaves 12 columns: another dense layer
        model = network(keepdims, axis)
        [dense] = [t for t in model.graph.initializer if t.name == "wd"]
        dense.CopyFrom(numpy_helper.from_array(np.ones((WIDTH, 1), np.float32), "wd"))
    else:
        model = network(keepdims, axis)
    found = quantise(model, rows())
    kinds = [node.op_type for node in found.model.graph.node]
    assert ("GlobalAveragePool" in kinds) is pooled
    x = rows(40, seed=3)
    expected = run(model, x)
    assert np.abs(run(found.model, x) - expected).max() < 0.02 * np.ptp(expected) + 0.05


def test_learnt_ranges_are_pinned_and_the_others_are_not(done) -> None:
    learnt = {"r0": Range(0.125, 0)}
    found = quantise(network(), rows(), learnt)
    assert found.ranges["r0"] == Range(0.125, 0)
    assert found.ranges["r1"] == done.ranges["r1"]


def test_a_learnt_range_holds_for_what_rearranges_the_value() -> None:
    found = quantise(network(), rows(), {"x": Range(0.5, 3)})
    assert found.ranges["h"] == Range(0.5, 3)


def test_a_value_that_only_rearranges_another_is_not_named_again(done) -> None:
    assert "f" not in done.ranges


def test_the_graph_that_was_given_is_left_as_it_was() -> None:
    model = network()
    before = model.SerializeToString()
    quantise(model, rows())
    assert model.SerializeToString() == before


def test_what_scales_the_result_is_float_and_follows_the_dense_layer() -> None:
    model = network()
    model.graph.node[-1].output[0] = "d"
    model.graph.node.append(helper.make_node("Mul", ["d", "w2"], ["y"]))
    model.graph.initializer.append(numpy_helper.from_array(np.array([3.0], np.float32), "w2"))
    found = quantise(model, rows())
    makers = {n.output[0]: n for n in found.model.graph.node}
    [scaling] = [n for n in found.model.graph.node if n.op_type == "Mul"]
    assert makers[scaling.input[0]].op_type == "Gemm"
    x = rows(40, seed=3)
    expected = run(model, x)
    assert np.abs(run(found.model, x) - expected).max() < 0.02 * np.ptp(expected) + 0.05
