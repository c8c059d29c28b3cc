"""What the C looks like to a compiler: no warning, no library, the same bytes each time."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from onnx import helper
from onnx_models import model_of, saved

from backends.c import compile as compile_module
from backends.c.compile import (
    QUICK,
    CompilerError,
    compile_files,
    compile_shared,
    missing_compiler,
)
from backends.c.emit import generate
from backends.c.kernels.prelude import bits, helpers
from backends.c.run import load
from backends.c.text import identifiers, number

needs_compiler = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
STRICT = ("-std=c99", "-O1", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")
CASES = [
    ("remnet", "fp32"),
    ("cnn1d", "fp32"),
    ("svm", "fp32"),
    ("none", "fp32"),
    ("remnet", "int8"),
    ("mlp", "int8"),
]


@needs_compiler
@pytest.mark.parametrize(("model", "backend"), CASES)
def test_it_compiles_without_a_warning_and_needs_only_memcpy(
    model, backend, built, tmp_path: Path
) -> None:
    requantise = "fixed" if model == "remnet" else "float"
    source = generate(built(model, backend).path, backend, requantise)
    made = tmp_path / "made.o"
    compile_files(source.files, tmp_path, (*STRICT, "-c", "-o", str(made)))
    if shutil.which("nm") is None:
        pytest.skip("no nm to list symbols with (Debian: binutils)")
    named = subprocess.run(["nm", "-u", made], capture_output=True, text=True, check=True).stdout
    assert set(named.split()) <= {"U", "memcpy"}


@pytest.mark.parametrize(("model", "backend"), [("remnet", "fp32"), ("remnet", "int8")])
def test_it_is_the_same_bytes_each_time_and_names_its_layers(model, backend, built) -> None:
    path = built(model, backend).path
    source, again = generate(path, backend), generate(path, backend)
    assert source == again
    text = source.files["uwb_predict.c"]
    for position, layer in enumerate(source.layers):
        assert re.fullmatch(rf"uwb_layer_{position:02d}_[a-z]+", layer)
        assert f"UWB_LAYER {layer}(" in text
    header = source.files["uwb_predict.h"]
    assert "#define UWB_PREDICT_SAMPLES 157" in header
    assert f"#define UWB_PREDICT_ARENA_BYTES {source.arena_bytes}" in header
    assert "int uwb_predict(const float cir[UWB_PREDICT_SAMPLES], float *error_m);" in header


@pytest.fixture
def small(tmp_path: Path) -> dict[str, str]:
    """The C of a graph with two inputs."""
    nodes = [
        helper.make_node("Concat", ["cir", "range"], ["all"], axis=1),
        helper.make_node("ReduceSum", ["all", "axes"], ["y"], keepdims=0),
    ]
    model = model_of(nodes, [("cir", 8), ("range", 1)], [("axes", np.array([1], np.int64))])
    return generate(saved(model, tmp_path), "fp32").files


@needs_compiler
@pytest.mark.parametrize("flag", ["-ffast-math", "-ffinite-math-only"])
def test_arithmetic_without_nan_is_refused_when_compiled(flag, small, tmp_path: Path) -> None:
    with pytest.raises(CompilerError, match="compile without -ffast-math"):
        compile_files(small, tmp_path, (flag, "-c", "-o", str(tmp_path / "made.o")))


@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler (g++)")
@needs_compiler
def test_cpp_links_with_it(small, tmp_path: Path) -> None:
    made = tmp_path / "made.o"
    compile_files(small, tmp_path, ("-c", "-o", str(made)))
    main = tmp_path / "main.cpp"
    main.write_text(
        '#include "uwb_predict.h"\n'
        "int main() { float cir[8] = {1}, range[1] = {2}, e = 0;\n"
        "return uwb_predict(cir, range, &e) != 0 || e != 3.0f; }\n"
    )
    subprocess.run(["g++", main, made, "-o", tmp_path / "main"], check=True)
    subprocess.run([tmp_path / "main"], check=True)


def test_memory_stays_within_a_microcontroller(built) -> None:
    assert generate(built("remnet", "fp32").path, "fp32").arena_bytes <= 17 * 1024
    assert generate(built("remnet", "int8").path, "int8").arena_bytes <= 4608


def test_numbers_and_names_are_c() -> None:
    assert number(1.0) == "1.0f"
    assert number(1e-20) == "9.99999968e-21f"
    assert number(float("nan")) == "(0.0f / 0.0f)"
    assert number(float("-inf")) == "-(1.0f / 0.0f)"
    for value in np.random.default_rng(0).normal(size=200).astype(np.float32):
        assert np.float32(number(value).rstrip("f")) == value
    assert identifiers(["x", "v0"]) == ["in_x", "in_v0"]
    assert identifiers(["cir", "int", "3d", "a b", "a-b", "uwb_x", ""]) == [
        *("cir", "in_int", "in_3d", "a_b", "a_b_", "in_uwb_x", "input"),
    ]


def test_named_inputs_become_pointers_in_order(tmp_path: Path) -> None:
    nodes = [
        helper.make_node("Concat", ["cir", "range m", "int"], ["all"], axis=1),
        helper.make_node("ReduceSum", ["all", "axes"], ["y"], keepdims=0),
    ]
    inputs = [("cir", 8), ("range m", 1), ("int", 3)]
    model = model_of(nodes, inputs, [("axes", np.array([1], np.int64))])
    header = generate(saved(model, tmp_path), "fp32").files["uwb_predict.h"]
    assert "#define UWB_PREDICT_RANGE_M_VALUES 1" in header
    assert (
        "int uwb_predict(const float cir[UWB_PREDICT_SAMPLES], "
        "const float range_m[UWB_PREDICT_RANGE_M_VALUES], "
        "const float in_int[UWB_PREDICT_IN_INT_VALUES], float *error_m);"
    ) in header


@pytest.fixture(scope="module")
def mathematics(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The functions of the prelude over arrays, compiled once."""
    names = ("exp", "sqrt", "sigmoid", "tanh", "log")
    lines = ["#include <stdint.h>", "#include <string.h>", *bits(), *helpers(names)]
    for name in names:
        loop = f"for (int i = 0; i < n; i++) {{ y[i] = uwb_{name}(x[i]); }}"
        lines.append(f"void all_{name}(const float *x, float *y, int n) {{ {loop} }}")
    folder = tmp_path_factory.mktemp("mathematics")
    return ctypes.CDLL(str(compile_shared({"m.c": "\n".join(lines)}, folder, QUICK)))


@needs_compiler
@pytest.mark.parametrize("name", ["exp", "sqrt", "sigmoid", "tanh", "log"])
def test_mathematics_without_a_library_is_close_to_a_library(name, mathematics) -> None:
    x = np.linspace(-80, 80, 4001, dtype=np.float32)
    if name in ("sqrt", "log"):
        x = np.geomspace(1e-30, 1e8, 4001, dtype=np.float32)
    exact = {
        "exp": np.exp,
        "sqrt": np.sqrt,
        "log": np.log,
        "tanh": np.tanh,
        "sigmoid": lambda v: 1 / (1 + np.exp(-v)),
    }[name](x.astype(np.float64))
    found = np.zeros_like(x)
    given, taken = (array.ctypes.data_as(ctypes.c_void_p) for array in (x, found))
    getattr(mathematics, f"all_{name}")(given, taken, len(x))
    assert np.abs(found - exact).max() <= 3e-7 * max(1.0, np.abs(exact).max())
    if name == "sqrt":
        assert np.array_equal(found, np.sqrt(x))
    if name == "exp":
        assert np.abs(found / exact - 1).max() < 3e-7


@needs_compiler
def test_odd_convolutions_and_pools_are_the_runtimes(tmp_path: Path) -> None:
    from backends.ort import open_plain

    rng = np.random.default_rng(0)
    tensors = [
        ("w", rng.normal(size=(6, 1, 3)).astype(np.float32)),
        ("v", rng.normal(size=(5, 6, 3)).astype(np.float32)),
        ("b", rng.normal(size=5).astype(np.float32)),
        ("u", rng.normal(size=(35, 1)).astype(np.float32)),
        ("slope", rng.normal(size=(6, 1)).astype(np.float32)),
        ("one", np.array([1], np.int64)),
        ("flat", np.array([-1, 35], np.int64)),
    ]
    nodes = [
        helper.make_node("Unsqueeze", ["x", "one"], ["a"]),
        helper.make_node("Conv", ["a", "w"], ["c"], pads=[2, 2], dilations=[2]),
        helper.make_node("LeakyRelu", ["c"], ["l"], alpha=0.3),
        helper.make_node("MaxPool", ["l"], ["m"], kernel_shape=[3], strides=[2], pads=[1, 1]),
        helper.make_node("PRelu", ["m", "slope"], ["p"]),
        helper.make_node("Tanh", ["p"], ["d"]),
        helper.make_node("Conv", ["d", "v", "b"], ["e"], strides=[2], pads=[1, 0]),
        helper.make_node(
            "AveragePool", ["e"], ["i"], kernel_shape=[3], pads=[1, 1], count_include_pad=1
        ),
        helper.make_node("AveragePool", ["i"], ["f"], kernel_shape=[2], pads=[1, 0]),
        helper.make_node("Reshape", ["f", "flat"], ["g"]),
        helper.make_node("MatMul", ["g", "u"], ["h"]),
        helper.make_node("Squeeze", ["h", "one"], ["y"]),
    ]
    path = saved(model_of(nodes, [("x", 29)], tensors), tmp_path)
    rows = rng.normal(size=(50, 29)).astype(np.float32)
    found, expected = load(generate(path, "fp32"), QUICK)(rows), open_plain(path)(rows)
    assert np.abs(found - expected).max() < 1e-5


@needs_compiler
def test_a_compiler_that_refuses_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(CompilerError, match="error"):
        compile_shared({"bad.c": "int main(void) { return }"}, tmp_path)


@pytest.fixture
def named(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], None]]:
    """A function that sets $CC."""
    from backends.c.compile import compiler

    def name(command: str) -> None:
        monkeypatch.setenv("CC", command)
        compiler.cache_clear()

    yield name
    compiler.cache_clear()


@pytest.mark.skipif(shutil.which("true") is None, reason="no `true` to take for a compiler")
@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("no-such-compiler", "CC=no-such-compiler: no such program"),
        ("/etc/passwd", "CC=/etc/passwd: no such program"),
        ("gcc '", "no such program"),
        ("true", "true made no library"),
        ("false -x", "false -x: failed without a word"),
    ],
)
def test_what_cc_names_is_used_or_refused(command, said, named, tmp_path: Path) -> None:
    named(command)
    with pytest.raises(CompilerError, match=said):
        compile_shared({"a.c": "int a;"}, tmp_path)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
def test_cc_may_have_arguments(named, tmp_path: Path) -> None:
    named("gcc -DGIVEN")
    compile_shared({"a.c": "#ifndef GIVEN\n#error\n#endif\nint a;"}, tmp_path)


def test_without_a_compiler_the_remedy_is_named(monkeypatch, tmp_path: Path) -> None:
    from backends.c import compile as compiling
    from backends.c.fp32 import CFp32Backend
    from zoo.none import NoMitigation

    monkeypatch.setattr(compiling, "compiler", lambda: None)
    assert "apt install gcc" in str(CFp32Backend().supports(NoMitigation()))
    with pytest.raises(CompilerError, match="native"):
        compile_shared({"a.c": ""}, tmp_path)


@needs_compiler
def test_trees_go_where_the_runtimes_go_unknown_values_too(tmp_path: Path) -> None:
    from backends.ort import open_plain

    tree = helper.make_node(
        "TreeEnsembleRegressor",
        ["range"],
        ["z"],
        domain="ai.onnx.ml",
        nodes_treeids=[0, 0, 0, 1, 1, 1, 1, 1],
        nodes_nodeids=[0, 1, 2, 0, 1, 2, 3, 4],
        nodes_featureids=[0, 0, 0, 1, 0, 2, 0, 0],
        nodes_values=[0.5, 0.0, 0.0, -0.25, 0.0, 0.125, 0.0, 0.0],
        nodes_modes=[
            "BRANCH_LEQ",
            "LEAF",
            "LEAF",
            "BRANCH_LEQ",
            "LEAF",
            "BRANCH_LEQ",
            *["LEAF"] * 2,
        ],
        nodes_truenodeids=[1, 0, 0, 2, 0, 3, 0, 0],
        nodes_falsenodeids=[2, 0, 0, 1, 0, 4, 0, 0],
        nodes_missing_value_tracks_true=[1, 0, 0, 0, 0, 1, 0, 0],
        target_treeids=[0, 0, 1, 1, 1],
        target_nodeids=[1, 2, 1, 3, 4],
        target_ids=[0] * 5,
        target_weights=[1.0, 2.0, 4.0, 8.0, 16.0],
        base_values=[0.5],
        n_targets=1,
    )
    squeeze = helper.make_node("Squeeze", ["z", "axes"], ["y"])
    model = model_of([tree, squeeze], [("range", 3)], [("axes", np.array([1], np.int64))])
    model.opset_import.append(helper.make_opsetid("ai.onnx.ml", 3))
    path = saved(model, tmp_path)
    values = np.array([-0.25, 0.125, 0.5, 0.6, np.nan], np.float32)
    rows = np.stack(np.meshgrid(values, values, values), -1).reshape(-1, 3)
    found, expected = load(generate(path, "fp32"), QUICK)(rows), open_plain(path)(rows).reshape(-1)
    assert len(np.unique(expected)) == 6
    assert np.array_equal(found, expected)


@needs_compiler
def test_inputs_beside_the_cir_may_be_unknown_and_the_cir_may_not(tmp_path: Path) -> None:
    nodes = [
        helper.make_node("ReduceSum", ["cir", "axes"], ["a"], keepdims=0),
        helper.make_node("Squeeze", ["range", "axes"], ["b"]),
        helper.make_node("IsNaN", ["b"], ["c"]),
        helper.make_node("Where", ["c", "zero", "b"], ["d"]),
        helper.make_node("Add", ["a", "d"], ["y"]),
        helper.make_node("Relu", ["b"], ["unused"]),
    ]
    tensors = [("axes", np.array([1], np.int64)), ("zero", np.array(0, np.float32))]
    model = model_of(nodes, [("cir", 2), ("range", 1)], tensors)
    model.graph.output.append(model.graph.output[0])
    model.graph.output[1].name = "unused"
    run = load(generate(saved(model, tmp_path), "fp32"), QUICK)
    rows = np.array([[1, 2, 3], [1, 2, np.nan]], np.float32)
    assert run(rows).tolist() == [6.0, 3.0]
    for bad in ([np.nan, 2, 3], [1, 2, np.inf]):
        with pytest.raises(ValueError, match="not finite"):
            run(np.array([bad], np.float32))


def test_a_compiler_that_is_none_is_named_with_what_was_expected(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("CC", "false")
    compile_module.compiler.cache_clear()
    try:
        with pytest.raises(CompilerError, match=r"CC=false: .*expected a C compiler.*unset CC"):
            compile_files({"a.c": "int a;\n"}, tmp_path, QUICK)
    finally:
        monkeypatch.undo()
        compile_module.compiler.cache_clear()


@needs_compiler
def test_a_complaint_names_no_file_of_a_folder_soon_gone(tmp_path: Path) -> None:
    with pytest.raises(CompilerError, match=r"a\.c.*error") as problem:
        compile_files({"a.c": "int a = ;\n"}, tmp_path, QUICK)
    assert str(tmp_path) not in str(problem.value)
