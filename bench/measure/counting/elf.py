"""What the counter reads from an ELF file: what goes where, what it takes, where functions lie."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.errors import BenchError

if TYPE_CHECKING:
    from elftools.elf.elffile import ELFFile

_LAYER = re.compile(r"uwb_layer_(\d+)_([A-Za-z0-9]+)")
_THUMB_BIT = 1
_MAPPING = ("$", ".L")  # symbols that mark code and data, not functions


@dataclass(frozen=True)
class Function:
    """A function's name and the addresses [start, end) of its instructions."""

    name: str
    start: int
    end: int

    @property
    def layer(self) -> tuple[int, str] | None:
        """Return the number and kind of the layer it stands for, None where it stands for none."""
        found = _LAYER.match(self.name)
        return (int(found[1]), found[2]) if found else None


@dataclass(frozen=True)
class Contents:
    """An image as the emulator needs it; all sizes in bytes.

    `segments` are (address, bytes); `symbols` addresses by name; `functions` in order of address.
    `code_bytes`, `constant_bytes` lie in flash, `data_bytes` in flash and RAM, `bss_bytes` in RAM;
    the mailbox is in none of them, the caller's input array neither.
    """

    segments: tuple[tuple[int, bytes], ...]
    symbols: dict[str, int]
    functions: tuple[Function, ...]
    code_bytes: int
    constant_bytes: int
    data_bytes: int
    bss_bytes: int

    @property
    def flash_bytes(self) -> int:
        """Code, constants and the initial values of variables."""
        return self.code_bytes + self.constant_bytes + self.data_bytes

    @property
    def static_ram_bytes(self) -> int:
        """Variables, the arena among them."""
        return self.data_bytes + self.bss_bytes


def read_elf(path: Path) -> Contents:
    """Return what an image holds. Raises BenchError where pyelftools is missing or it is no ELF."""
    try:
        from elftools.common.exceptions import ELFError
        from elftools.elf.elffile import ELFFile
    except ImportError:
        raise BenchError(missing_extra("pyelftools")) from None
    try:
        with path.open("rb") as stream:
            return _contents(ELFFile(stream))
    except (ELFError, OSError) as problem:
        raise BenchError(f"{path}: no ELF file: {problem}") from problem


def missing_extra(package: str) -> str:
    """Return the line for a package of the extra `count` that is not installed."""
    return f"counting needs {package}: pip install 'uwb-bench[count]'"


def _contents(elf: ELFFile) -> Contents:
    sizes = {section.name: int(section["sh_size"]) for section in elf.iter_sections()}
    table = elf.get_section_by_name(".symtab")
    symbols = [] if table is None else list(table.iter_symbols())
    return Contents(
        segments=tuple(
            (int(one["p_vaddr"]), one.data())
            for one in elf.iter_segments()
            if one["p_type"] == "PT_LOAD" and one["p_filesz"]
        ),
        symbols={one.name: int(one["st_value"]) for one in symbols if one.name},
        functions=_functions(symbols),
        code_bytes=sizes.get(".text", 0),
        constant_bytes=sizes.get(".rodata", 0) + sizes.get(".ARM.exidx", 0),
        data_bytes=sizes.get(".data", 0),
        bss_bytes=sizes.get(".bss", 0),
    )


def _functions(symbols: list[Any]) -> tuple[Function, ...]:
    """Return functions in order of address; one without a size ends where the next begins."""
    found = {}
    for symbol in symbols:
        info, name = symbol["st_info"], symbol.name
        if info["type"] == "STT_FUNC" and name and not name.startswith(_MAPPING):
            start = int(symbol["st_value"]) & ~_THUMB_BIT
            found[start] = (name, int(symbol["st_size"]))
    starts = sorted(found)
    ends = [*starts[1:], starts[-1] + found[starts[-1]][1]] if starts else []
    return tuple(
        Function(found[start][0], start, start + found[start][1] if found[start][1] else end)
        for start, end in zip(starts, ends, strict=True)
    )
