"""C against torch in float64 and against ONNX Runtime, as each promises."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
import torch

from backends.c.compile import FLAGS, NATIVE, QUICK, compile_shared, missing_compiler
from backends.c.emit import generate
from backends.c.kernels.prelude import bits, helpers
from backends.c.run import load
from backends.ort import open_optimised

pytestmark = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
SCALAR = (*QUICK, "-DUWB_SCALAR")


@pytest.mark.parametrize(
    ("model", "limit_m"),
    [("remnet", 1e-6), ("cnn1d", 1e-6), ("mlp", 1e-6), ("svm", 1e-6), ("none", 0.0)],
)
def test_float_c_is_torch_in_float64(model, limit_m, built, fitted, test_rows) -> None:
    source = generate(built(model, "fp32").path, "fp32")
    found = load(source, QUICK)(test_rows[0])
    with torch.inference_mode():
        exact = fitted(model).to_module().double()(torch.tensor(test_rows[0]).double()).numpy()
    assert np.abs(found - exact).max() <= limit_m


@pytest.mark.parametrize("model", ["remnet", "mlp", "svm"])
def test_every_vector_width_gives_the_same_bits(model, built, test_rows) -> None:
    source = generate(built(model, "fp32").path, "fp32")
    rows = test_rows[0][:100]
    builds = [load(source, flags)(rows) for flags in (SCALAR, QUICK, (*FLAGS, NATIVE))]
    assert np.array_equal(builds[0], builds[1])
    assert np.array_equal(builds[0], builds[2])


@pytest.mark.parametrize("model", ["remnet", "cnn1d"])
@pytest.mark.parametrize("backend", ["int8", "qat"])
@pytest.mark.parametrize("requantise", ["float", "fixed"])
def test_8_bit_c_is_the_runtime_bit_by_bit(model, backend, requantise, built, test_rows) -> None:
    path = built(model, backend).path
    found = load(generate(path, "int8", requantise), SCALAR)(test_rows[0])
    expected = open_optimised(path)(test_rows[0])
    assert len(np.unique(expected)) > 20
    if requantise == "float":
        assert np.array_equal(found, expected)
    assert np.mean(found == expected) >= 0.999
    assert np.abs(found - expected).max() <= 1e-3


@pytest.mark.parametrize("model", ["remnet", "cnn1d"])
def test_a_cortex_m0s_way_gives_the_same_bits(model, built, test_rows) -> None:
    """Its sums and its rounding in 20 bits are other C, which this machine runs as well."""
    source = generate(built(model, "int8").path, "int8", "fixed")
    assert "uwb_scaled_quick" in source.files["uwb_predict.c"]
    builds = [
        load(source, (*QUICK, flag))(test_rows[0]) for flag in ("-D__ARM_ARCH_6M__", "-DUWB_PLAIN")
    ]
    assert np.array_equal(*builds)


def test_8_bit_c_after_features_is_the_runtime_nearly_always(built, test_rows) -> None:
    path = built("mlp", "int8").path
    found = load(generate(path, "int8"), QUICK)(test_rows[0])
    expected = open_optimised(path)(test_rows[0])
    assert np.mean(found == expected) >= 0.999


def test_half_precision_weights_stay_16_bits_and_are_widened_when_read(built, test_rows) -> None:
    path = built("remnet", "fp16").path
    whole, kept = generate(path, "fp32"), generate(path, "fp16")
    assert "static const uint16_t uwb_weight_" in kept.files["uwb_predict.c"]
    assert len(kept.files["uwb_predict.c"]) < 0.8 * len(whole.files["uwb_predict.c"])
    found = load(kept, QUICK)(test_rows[0])
    assert np.array_equal(found, load(whole, QUICK)(test_rows[0]))
    assert np.abs(found - open_optimised(path)(test_rows[0])).max() < 1e-5


def test_every_16_bit_number_is_widened_exactly(tmp_path: Path) -> None:
    """The generic way; a Cortex-M4F's own instruction is IEEE 754's."""
    heads = ["#include <stdint.h>", "#include <string.h>", *bits(), *helpers({"half"})]
    loop = "for (int i = 0; i < n; i++) { x[i] = uwb_half(h[i]); }"
    text = "\n".join([*heads, f"void widen(const uint16_t *h, float *x, int n) {{ {loop} }}"])
    library = ctypes.CDLL(str(compile_shared({"half.c": text}, tmp_path, QUICK)))
    numbers = np.arange(1 << 16, dtype=np.uint16)
    halves = numbers[np.isfinite(numbers.view(np.float16))]
    found = np.zeros(len(halves), np.float32)
    library.widen(
        halves.ctypes.data_as(ctypes.c_void_p), found.ctypes.data_as(ctypes.c_void_p), len(halves)
    )
    assert np.array_equal(found, halves.view(np.float16).astype(np.float32))


@pytest.mark.parametrize("model", ["remnet", "mlp"])
def test_a_graph_with_fused_operators_is_read_too(model, built, test_rows) -> None:
    path = built(model, "graph").path
    found = load(generate(path, "fp32"), QUICK)(test_rows[0])
    assert np.abs(found - open_optimised(path)(test_rows[0])).max() < 1e-5


@pytest.mark.parametrize(("model", "backend"), [("remnet", "fp32"), ("mlp", "int8")])
def test_odd_inputs_give_what_is_promised(model, backend, built, tmp_path: Path) -> None:
    precision = "fp32" if backend == "fp32" else "int8"
    path = built(model, backend).path
    run = load(generate(path, precision), QUICK)
    for odd in (np.nan, np.inf, -np.inf, 1.1e9):
        row = np.ones((1, 157), np.float32)
        row[0, 156] = odd
        with pytest.raises(ValueError, match="not finite, or out of the range"):
            run(row)
    zeros = np.zeros((1, 157), np.float32)
    assert abs(run(zeros)[0] - open_optimised(path)(zeros)[0]) < 1e-3
    for extreme in (np.full((1, 157), 1e9, np.float32), np.full((1, 157), -46341.0, np.float32)):
        assert np.isfinite(run(extreme)).all()


def test_the_runner_refuses_other_rows(built) -> None:
    run = load(generate(built("none", "fp32").path, "fp32"), QUICK)
    for rows in (np.ones((2, 156), np.float32), np.ones((2, 157)), np.ones(157, np.float32)):
        with pytest.raises(ValueError, match=r"expected rows float32 \[n, 157\]"):
            run(rows)
    assert run(np.ones((0, 157), np.float32)).shape == (0,)
    wide = np.ones((3, 314), np.float32)[:, ::2]
    assert np.array_equal(run(wide), run(np.ones((3, 157), np.float32)))


@pytest.mark.parametrize("operator", ["QLinearAdd", "QLinearMul"])
def test_every_pair_of_8_bit_values_is_the_runtimes(operator, tmp_path: Path) -> None:
    """All 65 536 pairs, with zero points: an addition's order of rounding shows in 1 of 10^6."""
    from onnx import helper, numpy_helper
    from onnx_models import model_of, saved

    from backends.ort import run_once

    rng = np.random.default_rng(5)
    a_scale, b_scale, y_scale = rng.uniform(1e-3, 3e-3, 3) * [1, 1, 1 if "Add" in operator else 0.3]
    held = {"s": a_scale, "u": b_scale, "v": y_scale, "one": 1.0}
    zeros = {"sz": 31, "uz": 7, "vz": 101, "onez": 0}
    tensors = [(n, np.array(v, np.float32)) for n, v in held.items()]
    tensors += [(n, np.array(v, np.uint8)) for n, v in zeros.items()]
    scales = ["s", "sz", "b8", "u", "uz", "v", "vz"]
    nodes = [
        helper.make_node("Slice", ["x", "zero", "one64", "one64"], ["a"]),
        helper.make_node("Slice", ["x", "one64", "two", "one64"], ["b"]),
        helper.make_node("QuantizeLinear", ["a", "one", "onez"], ["a8"]),
        helper.make_node("QuantizeLinear", ["b", "one", "onez"], ["b8"]),
        helper.make_node(operator, ["a8", *scales], ["y8"], domain="com.microsoft"),
        helper.make_node("DequantizeLinear", ["y8", "one", "onez"], ["z"]),
        helper.make_node("Squeeze", ["z", "one64"], ["y"]),
    ]
    places = {"zero": 0, "one64": 1, "two": 2}
    tensors += [(n, np.array([v], np.int64)) for n, v in places.items()]
    model = model_of(nodes, [("x", 2)], tensors)
    model.opset_import.append(helper.make_opsetid("com.microsoft", 1))
    assert numpy_helper.to_array(model.graph.initializer[0]) > 0
    pairs = np.stack(np.meshgrid(np.arange(256), np.arange(256)), -1).reshape(-1, 2)
    rows = pairs.astype(np.float32)
    found = load(generate(saved(model, tmp_path), "int8"), QUICK)(rows)
    expected = run_once(model, rows)[0]
    assert len(np.unique(expected)) > 100
    assert np.array_equal(found, expected)
    fixed = load(generate(saved(model, tmp_path), "int8", "fixed"), QUICK)(rows)
    assert np.mean(fixed == expected) > 0.999
    assert np.abs(fixed - expected).max() <= 1


def test_8_bit_layers_that_stand_between_are_the_runtimes(tmp_path: Path) -> None:
    """QLinearMatMul, sums and products with one constant, and parts of different scales joined."""
    from onnx import helper
    from onnx_models import model_of, saved

    rng = np.random.default_rng(7)
    floats = {"s": 0.02, "t": 0.05, "u": 0.3, "v": 0.7, "k": 0.011}
    zeros = {"z": 128, "tz": 120, "uz": 3, "vz": 99, "kz": 1, "c": 200}
    tensors = [(n, np.array(v, np.float32)) for n, v in floats.items()]
    tensors += [(n, np.array(v, np.uint8)) for n, v in zeros.items()]
    tensors += [
        ("w", rng.integers(-127, 128, (4, 6)).astype(np.int8)),
        ("ws", rng.uniform(0.001, 0.01, 6).astype(np.float32)),
        ("wz", np.zeros(6, np.int8)),
        ("axes", np.array([1], np.int64)),
    ]
    own = {"domain": "com.microsoft"}
    nodes = [
        helper.make_node("QuantizeLinear", ["x", "s", "z"], ["a"]),
        helper.make_node("QLinearMatMul", ["a", "s", "z", "w", "ws", "wz", "t", "tz"], ["m"]),
        helper.make_node("QLinearMul", ["m", "t", "tz", "c", "k", "kz", "u", "uz"], ["p"], **own),
        helper.make_node("QLinearAdd", ["c", "k", "kz", "p", "u", "uz", "v", "vz"], ["q"], **own),
        helper.make_node(
            "QLinearConcat", ["v", "vz", "q", "v", "vz", "a", "s", "z"], ["j"], axis=1, **own
        ),
        helper.make_node("DequantizeLinear", ["j", "v", "vz"], ["d"]),
        helper.make_node("ReduceSum", ["d", "axes"], ["y"], keepdims=0),
    ]
    model = model_of(nodes, [("x", 4)], tensors)
    model.opset_import.append(helper.make_opsetid("com.microsoft", 1))
    path = saved(model, tmp_path)
    rows = rng.normal(size=(2000, 4)).astype(np.float32)
    expected = open_optimised(path)(rows)
    assert len(np.unique(expected)) > 20
    for how in ("float", "fixed"):
        found = load(generate(path, "int8", how), QUICK)(rows)
        assert np.abs(found - expected).max() < 1e-4  # the last sum is of floats
