"""Cycles of basic blocks by hand, against the manuals' rules."""

from __future__ import annotations

import numpy as np
import pytest

from bench.errors import BenchError
from bench.measure.counting import load_core
from bench.measure.counting.cycles import block_cost
from bench.measure.counting.instructions import disassembler

pytest.importorskip("capstone")
THUMB = {
    "ldr r0, [r1]": "0868",
    "ldr r2, [r3]": "1a68",
    "adds r2, r2, r0": "1218",
    "str r2, [r3]": "1a60",
    "muls r0, r1": "4843",
    "vadd s0, s0, s1": "30eea00a"[:8],
    "vmul s2, s0, s0": "20ee001a",
    "vmul s4, s6, s6": "23ee032a",
    "vldr s6, [r0]": "90ed003a",
    "vfma s0, s1, s2": "a0ee810a",
    "vdiv s0, s0, s1": "80ee200a",
    "udiv r0, r0, r1": "b0fbf1f0",
    "push {r4, lr}": "10b5",
    "pop {r4, pc}": "10bd",
    "ldrd r2, r3, [r1]": "d1e90023",
    "vpush {s16-s19}": "2ded048a",
    "bl +0": "00f000f8",
    "bne -4": "fcd1",
    "bx lr": "7047",
    "nop": "00bf",
}


def _cost(core: str, *lines: str):
    code = bytes.fromhex("".join(THUMB[line] for line in lines))
    return block_cost(disassembler("thumb")(code, 0x8000000), load_core(core))


def _typical(core: str, *lines: str) -> float:
    return float(_cost(core, *lines).cycles[1])


@pytest.mark.parametrize(
    ("lines", "cycles"),
    [
        (("adds r2, r2, r0",), 1),
        (("ldr r0, [r1]",), 2),
        (("ldr r0, [r1]", "ldr r2, [r3]"), 1 + 2),  # neighbours pipeline
        (("ldr r0, [r1]", "adds r2, r2, r0"), 2 + 1),
        (("ldr r0, [r1]", "vldr s6, [r0]"), 2 + 2),  # the address is the value loaded
        (("ldr r2, [r3]", "str r2, [r3]"), 2 + 1),
        (("muls r0, r1",), 1),
        (("push {r4, lr}",), 1 + 2),
        (("ldrd r2, r3, [r1]",), 1 + 2),
        (("vpush {s16-s19}",), 1 + 4),
        (("vadd s0, s0, s1", "vmul s2, s0, s0"), 2 + 1),  # the sum is used at once
        (("vadd s0, s0, s1", "vmul s4, s6, s6"), 1 + 1),
        (("vfma s0, s1, s2", "nop"), 3 + 1),
        (("vdiv s0, s0, s1", "nop"), 14 + 1),
        (("udiv r0, r0, r1",), 7),
    ],
)
def test_cortex_m4_blocks_by_hand(lines, cycles):
    assert _typical("cortex-m4f", *lines) == cycles


@pytest.mark.parametrize(
    ("core", "line", "not_taken", "taken"),
    [
        ("cortex-m4f", "bne -4", 1, 3),
        ("cortex-m4f", "bx lr", 1, 3),
        ("cortex-m4f", "pop {r4, pc}", 1 + 2, 1 + 2 + 2),
        ("cortex-m0plus", "bne -4", 1, 2),
        ("cortex-m0plus", "bl +0", 1, 3),
        ("cortex-m0plus", "pop {r4, pc}", 3, 3 + 1),
    ],
)
def test_a_taken_branch_costs_more(core, line, not_taken, taken):
    cost = _cost(core, line)
    assert cost.cycles[1] == not_taken
    assert cost.cycles[1] + cost.taken[1] == taken


def test_dual_issue_scales_the_whole():
    lines = ("ldr r0, [r1]", "ldr r2, [r3]", "adds r2, r2, r0", "bne -4")
    one, two = _cost("cortex-m4f", *lines), _cost("cortex-m7", *lines)
    np.testing.assert_allclose(two.cycles, one.cycles * [0.5, 0.68, 1])
    np.testing.assert_allclose(two.taken, one.taken * [0.5, 0.68, 1])


def test_kinds_are_counted():
    kinds = _cost("cortex-m4f", "push {r4, lr}", "vldr s6, [r0]", "vfma s0, s1, s2", "bl +0").kinds
    assert kinds == {"store": 1, "load": 1, "float_mac": 1, "call": 1}


@pytest.mark.parametrize(
    ("family", "code", "kinds"),
    [
        ("riscv32", "8c41" + "2e95" + "b385c502" + "6780" * 0 + "8280", ["load", "integer",
         "multiply", "return"]),
        ("riscv32", "23a0a500" + "e39e05fe" + "ef000001", ["store", "branch", "call"]),
        ("aarch64", "200440bd" + "0008211e" + "2010010e" * 0 + "c0035fd6", ["load", "float",
         "return"]),
        ("aarch64", "2004c03d" + "20cc214e" + "41000054", ["load", "float_mac", "branch"]),
    ],
)  # fmt: skip
def test_other_families_are_told_apart(family, code, kinds):
    assert [one.kind for one in disassembler(family)(bytes.fromhex(code), 0x8000000)] == kinds


def test_bytes_that_are_no_instruction_are_an_error():
    with pytest.raises(BenchError, match="no thumb instruction at 0x8000002"):
        disassembler("thumb")(bytes.fromhex("00bfffff"), 0x8000000)
