"""Counting a small network: its answers, that every sum adds up, and the limits."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
import toy

from backends.c.emit import write_program
from backends.c.operators import (
    Buffer,
    Copy,
    Dequantise,
    Input,
    Loop,
    Program,
    Quantise,
    Ref,
    Scale,
    Step,
    Table,
)
from bench.errors import BenchError
from bench.measure.counting import build_image, count_image, emulate, load_core
from bench.measure.counting.core import core_names
from bench.measure.counting.elf import read_elf


@pytest.fixture(scope="module")
def counted(shared_tools):
    tools = shared_tools
    rows = toy.cirs(3)
    return rows, count_image(build_image(toy.FILES, tools), tools, rows)


def test_the_emulated_answers_are_the_exact_ones(counted):
    rows, count = counted
    np.testing.assert_array_equal(count.outputs_m, toy.expected_m(rows))
    assert count.statuses.tolist() == [0, 0, 0]


def test_layers_and_kinds_add_up_to_the_whole(counted):
    _, count = counted
    assert [(one.name, one.kind) for one in count.layers[1:]] == [
        *[("00", "move"), ("01", "conv"), ("02", "reduce")]
    ]
    assert sum(one.instructions for one in count.layers) == pytest.approx(count.instructions)
    assert sum(one.cycles.typical for one in count.layers) == pytest.approx(count.cycles.typical)
    assert sum(count.kinds.values()) == pytest.approx(count.instructions)
    assert count.fewest <= count.instructions <= count.most
    assert count.counted_rows == count.rows == 3


def test_the_work_is_where_the_loops_are(counted):
    # 765 multiplications, 765 + 153 additions; taps from flash; half a memory of two arrays.
    _, count = counted
    assert count.kinds["float"] + 2 * count.kinds.get("float_mac", 0) >= 765 * 2 + 153
    assert count.kinds.get("float_divide", 0) <= 1
    assert count.layers[2].instructions > 0.6 * count.instructions  # gcc 0.8, zig cc 0.72
    assert count.instructions < count.cycles.low <= count.cycles.typical <= count.cycles.high


def test_sizes_are_of_the_network_alone(counted):
    _, count = counted
    assert count.static_ram_bytes == 314 * 4 + 8  # the arena, aligned to 16
    assert count.constant_bytes >= 0
    assert 100 < count.code_bytes < 3000
    assert 0 < count.stack_bytes < 300
    assert count.flash_bytes == count.code_bytes + count.constant_bytes


def test_images_are_kept(tools, monkeypatch):
    first = build_image(toy.FILES, tools)
    monkeypatch.setattr("bench.measure.counting.compile._compile", lambda *_: pytest.fail("again"))
    assert build_image(toy.FILES, tools) == first
    assert b"uwb_layer_01_conv" in first.path.read_bytes()
    names = [one.layer for one in read_elf(first.path).functions if one.layer]
    assert sorted(names) == [(0, "move"), (1, "conv"), (2, "reduce")]


@pytest.mark.parametrize("name", ["cortex-m0plus", "cortex-m33", "cortex-m7"])
def test_other_cores_give_the_same_answers(tools, name):
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("arm-none-eabi-gcc (Debian: gcc-arm-none-eabi) is not installed")
    core, rows = load_core(name), toy.cirs(1)
    count = count_image(build_image(toy.FILES, core), core, rows)
    np.testing.assert_array_equal(count.outputs_m, toy.expected_m(rows))
    soft = not core.float_unit
    assert (count.instructions > 60_000) == soft
    assert ("float" in count.kinds) != soft


def test_a_network_that_does_not_end_is_stopped(tools, monkeypatch):
    monkeypatch.setattr(emulate, "MAX_INSTRUCTIONS", 100_000)
    endless = "volatile int x; int uwb_predict(const float *c, float *e) { for (;;) x++; }"
    image = build_image({**toy.FILES, "uwb_predict.c": endless}, tools)
    with pytest.raises(BenchError, match=r"the emulator stopped: .*did not return within"):
        count_image(image, tools, toy.cirs(1))


def test_a_wild_pointer_is_an_error_of_one_line(tools):
    wild = "int uwb_predict(const float *c, float *e) { *(int *)0x60000000 = 1; return 0; }"
    image = build_image({**toy.FILES, "uwb_predict.c": wild}, tools)
    with pytest.raises(BenchError, match="the emulator stopped") as caught:
        count_image(image, tools, toy.cirs(1))
    assert "\n" not in str(caught.value)


def test_c_that_does_not_compile_is_an_error_of_one_line(tools):
    with pytest.raises(BenchError, match=r"failed: .*error") as caught:
        build_image({**toy.FILES, "uwb_predict.c": "int uwb_predict(void) { return x; }"}, tools)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["../evil.c", "a b.c", "mailbox.c", "x.s", "-o.c", "a/b.h"])
def test_only_plain_file_names_are_compiled(tools, name):
    with pytest.raises(BenchError, match="a plain name"):
        build_image({name: ""}, tools)


def test_no_rows_and_no_elf_are_errors(tools, tmp_path):
    with pytest.raises(BenchError, match="no rows"):
        count_image(build_image(toy.FILES, tools), tools, toy.cirs(0))
    (tmp_path / "x.elf").write_text("no")
    with pytest.raises(BenchError, match="no ELF file"):
        read_elf(tmp_path / "x.elf")


def test_without_a_compiler_the_way_to_one_is_named(monkeypatch):
    monkeypatch.setattr("bench.measure.counting.compile.shutil.which", lambda _: None)
    monkeypatch.setattr("bench.measure.counting.compile.find_spec", lambda _: None)
    said = r"uwb-bench\[native\].* or Debian's package gcc-arm-none-eabi"
    with pytest.raises(BenchError, match=said):
        build_image(toy.FILES, load_core("cortex-m4f"))
    with pytest.raises(BenchError, match=r"for rv32imc: pip install 'uwb-bench\[native\]'"):
        build_image(toy.FILES, load_core("rv32imc"))


@pytest.mark.parametrize("package", ["unicorn", "capstone", "elftools"])
def test_without_an_emulator_the_extra_is_named(monkeypatch, package):
    there = emulate.find_spec
    monkeypatch.setattr(emulate, "find_spec", lambda name: None if name == package else there(name))
    with pytest.raises(BenchError, match=r"pip install 'uwb-bench\[count\]'"):
        emulate.check_tools()


@pytest.mark.parametrize("name", core_names())
def test_every_price_has_an_order_and_a_source(name):
    core = load_core(name)
    assert core.name == name
    for price in (*core.prices.values(), core.issue):
        assert price.low <= price.typical <= price.high
        assert len(price.source) > 10


def test_an_unknown_core_is_named():
    with pytest.raises(BenchError, match="did you mean 'cortex-m4f'"):
        load_core("cortex-m4")


def test_gcc_leaves_no_transposing_layer_out(tools):
    """GCC 12.2 for Arm did, at every -O, where it saw that both sides are parts of one arena."""
    weights = np.arange(64, dtype=np.float32)
    bytes_in, bytes_out, floats = (Ref(number, (64,), (1,)) for number in (1, 2, 3))
    product = Step("multiply", (Input(0), Input(1)))
    result = Ref(4, (1,), (1,))
    operators = (
        Quantise(Ref(0, (64,), (1,)), bytes_in, Scale(1.0, 0)),
        Copy(Ref(1, (8, 8), (1, 8)), Ref(2, (8, 8), (8, 1))),
        Dequantise(bytes_out, floats, Scale(1.0, 0)),
        Loop((floats, Table(weights, (1,))), result, (64,), (0,), (product,), "sum", "sum"),
    )
    sizes = [(64, "f32", "cir"), (64, "u8", None), (64, "u8", None), (64, "f32", None)]
    buffers = tuple(Buffer(*one) for one in [*sizes, (1, "f32", None)])
    source = write_program(Program(operators, buffers, (0,), result))
    rows = np.random.default_rng(0).integers(0, 200, (2, 64)).astype(np.float32)
    count = count_image(build_image(dict(source.files), tools), tools, rows)
    transposed = rows.reshape(-1, 8, 8).transpose(0, 2, 1).reshape(-1, 64)
    np.testing.assert_array_equal(count.outputs_m, transposed @ weights)
    assert any(one.kind == "copy" and one.instructions > 64 for one in count.layers)
