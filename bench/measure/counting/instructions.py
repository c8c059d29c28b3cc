"""Basic blocks as instructions: each block is disassembled once, whatever its count."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from bench.errors import BenchError
from bench.measure.counting.core import Family
from bench.measure.counting.elf import missing_extra

if TYPE_CHECKING:
    from capstone import Cs

Kind = Literal[
    "integer", "multiply", "divide", "load", "store", "branch", "call", "return",
    "float", "float_mac", "float_divide", "other",
]  # fmt: skip
Rule = tuple[re.Pattern[str], Kind]


@dataclass(frozen=True)
class Instruction:
    """One instruction: its kind, the registers it reads and writes, the words it moves.

    `multiple`: it is one of the loads and stores of several registers; `words` is 1 elsewhere.
    """

    kind: Kind
    words: int
    multiple: bool
    reads: frozenset[str]
    writes: frozenset[str]


def disassembler(family: Family) -> Callable[[bytes, int], Sequence[Instruction]]:
    """Return a function from code and its address to its instructions.

    Raises BenchError where capstone is not installed; the function raises it for bytes that are
    no instruction.
    """
    try:
        import capstone
    except ImportError:
        raise BenchError(missing_extra("capstone")) from None
    arch, mode = {
        "thumb": (capstone.CS_ARCH_ARM, capstone.CS_MODE_THUMB | capstone.CS_MODE_MCLASS),
        "riscv32": (
            capstone.CS_ARCH_RISCV,
            capstone.CS_MODE_RISCV32 | capstone.CS_MODE_RISCVC,
        ),
        "aarch64": (capstone.CS_ARCH_ARM64, capstone.CS_MODE_ARM),
    }[family]
    engine = capstone.Cs(arch, mode)
    engine.detail = True
    return lambda code, address: list(_decoded(engine, family, code, address))


def _decoded(engine: Cs, family: Family, code: bytes, address: int) -> Iterator[Instruction]:
    done = 0
    for one in engine.disasm(code, address):
        done += one.size
        yield _instruction(one, family)
    if done != len(code):
        raise BenchError(f"no {family} instruction at {address + done:#x}")


def _instruction(one: Any, family: Family) -> Instruction:
    mnemonic, operands = one.mnemonic.removesuffix(".w"), one.op_str
    kind = _kind(mnemonic, operands, family)
    count = _words(mnemonic, operands, family) if kind in ("load", "store", "return") else 1
    reads, writes = one.regs_access() if family != "riscv32" else _riscv_registers(one)
    name = one.reg_name
    return Instruction(
        kind,
        max(count, 1),
        count > 1 or mnemonic.startswith(_MULTIPLE),
        frozenset(_plain(name(register)) for register in reads),
        frozenset(_plain(name(register)) for register in writes),
    )


def _plain(register: str) -> str:
    return str(register).removesuffix("_int")


def _riscv_registers(one: Any) -> tuple[list[int], list[int]]:
    """Return registers read and written; capstone's RISC-V tables do not say, the operands do.

    The first operand of a store or branch is read, of everything else written.
    """
    used = [operand.value.reg for operand in one.operands if operand.type == 1]
    used += [operand.value.mem.base for operand in one.operands if operand.type == 3]
    first_is_read = re.match(r"(c\.)?(s[bhw]|swsp|b)", one.mnemonic) is not None
    return (used, []) if first_is_read else (used[1:], used[:1])


_MULTIPLE = ("ldm", "stm", "push", "pop", "vldm", "vstm", "vpush", "vpop", "ldrd", "strd")


def _words(mnemonic: str, operands: str, family: Family) -> int:
    """Return how many words a load or store moves; 1 for single ones."""
    if family == "thumb" and mnemonic.startswith(("ldrd", "strd")):
        return 2
    if family == "thumb" and mnemonic.startswith(_MULTIPLE):
        doubles = 2 if re.search(r"\bd\d", operands) else 1
        return doubles * len(re.findall(r"\b(?:[rsd]\d+|sb|sl|fp|ip|lr|pc)\b", _list(operands)))
    if family == "aarch64" and mnemonic in ("ldp", "stp", "ldpsw"):
        return 2
    return 1


def _list(operands: str) -> str:
    """Return the register list in braces, ranges written out."""
    inside = operands.partition("{")[2].partition("}")[0]

    def spelt(found: re.Match[str]) -> str:
        letter, first, last = found[1], int(found[2]), int(found[3])
        return ", ".join(f"{letter}{number}" for number in range(first, last + 1))

    return re.sub(r"\b([rsd])(\d+)\s*-\s*[rsd](\d+)\b", spelt, inside)


def _rules(*pairs: tuple[str, Kind]) -> tuple[Rule, ...]:
    return tuple((re.compile(pattern), kind) for pattern, kind in pairs)


_COND = "(eq|ne|hs|cs|lo|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le|al)?"
RULES = {
    "thumb": _rules(
        (r"vldr|vldm|vpop|ldr|ldm|pop", "load"),
        (r"vstr|vstm|vpush|str|stm|push", "store"),
        (rf"v(fn?m[as]|n?ml[as]){_COND}(\.|$)", "float_mac"),
        (r"vdiv|vsqrt", "float_divide"),
        (r"v", "float"),
        (rf"blx?{_COND}$", "call"),
        (rf"bx{_COND}$", "return"),
        (rf"b{_COND}(\.[nw])?$|cbn?z|tb[bh]", "branch"),
        (r"[su]div", "divide"),
        (r"ml[as]|mul|[su]m(ul|la|ls|mul|mla|mls|ua|us|aal)|smul|umull", "multiply"),
        (r"nop|it|dsb|dmb|isb|bkpt|svc|cps|hint", "other"),
        (r"", "integer"),
    ),
    "riscv32": _rules(
        (r"(c\.)?l(b|h|w|bu|hu|wsp)$|c\.lwsp", "load"),
        (r"(c\.)?s(b|h|w)$|c\.swsp", "store"),
        (r"(c\.)?(jal|jalr)$|call", "call"),
        (r"(c\.)?(jr|ret)$", "return"),
        (r"(c\.)?(j|b\w+)$", "branch"),
        (r"mul", "multiply"),
        (r"div|rem", "divide"),
        (r"(c\.)?nop|fence|e(call|break)", "other"),
        (r"", "integer"),
    ),
    "aarch64": _rules(
        (r"ld", "load"),
        (r"st", "store"),
        (r"f(n?m(add|sub)|ml[as])|sdot|udot|[su]?ml[as]l?2?$", "float_mac"),
        (r"fdiv|fsqrt", "float_divide"),
        (r"f|scvtf|ucvtf", "float"),
        (r"blr?$", "call"),
        (r"ret|br$", "return"),
        (r"b(\.\w+)?$|cbn?z|tbn?z", "branch"),
        (r"[su]div", "divide"),
        (r"m(ul|add|sub|neg)|[su]m(ull|addl|subl|ulh)", "multiply"),
        (r"nop|hint|isb|dsb|dmb", "other"),
        (r"", "integer"),
    ),
}
"""By family, which mnemonics are of which kind; the first pattern that fits decides."""


def _kind(mnemonic: str, operands: str, family: Family) -> Kind:
    if family == "thumb" and mnemonic.startswith(("pop", "ldm", "ldr")) and _loads_pc(operands):
        return "return"
    if family == "riscv32" and mnemonic == "c.jr":
        return "return"
    return next(kind for pattern, kind in RULES[family] if pattern.match(mnemonic))


def _loads_pc(operands: str) -> bool:
    return "pc}" in operands or operands.startswith("pc,")
