"""The process that emulates a core: `python -m bench.measure.counting.emulator REQUEST ANSWER`.

Unicorn's text says GPLv2: it is imported here and nowhere else, in a process of its own that the
harness talks to through two files (.npz). It needs no other module of the project.

REQUEST: `settings` (JSON text: family, model, symbols, limits), `segment_N` at `addresses[N]`,
`inputs` float32 [rows, samples], `layers` [n, 2] address ranges.
ANSWER: `outputs` [rows], `statuses` [rows], `stack_bytes`, `flash_reads`, and one row per counted
row, layer and basic block that was entered: `visits` int64 [m, 6]: row, layer (-1: none), address,
bytes, times entered, times left by a taken branch. Every row is run; where a call enters millions
of blocks (soft float) only the first few are counted, at least one.
"""

from __future__ import annotations

import array
import importlib
import json
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import unicorn
from numpy.typing import NDArray

FLASH, RAM, SIZE = 0x08000000, 0x20000000, 0x01000000
STACK_TOP = RAM + SIZE
STACK_BYTES = 0x00100000
FILL = 0xA5
SHORTEST = 2  # bytes of an instruction
TRIES = 3  # at watching memory
_BITS = 16  # of an entry of the trace that hold the block's bytes
Words = NDArray[np.int64]
Segments = list[tuple[int, bytes]]
FAMILIES = {
    "thumb": ("ARCH_ARM", ("MODE_THUMB", "MODE_MCLASS"), "arm", "ARM", "SP", "LR"),
    "riscv32": ("ARCH_RISCV", ("MODE_RISCV32",), "riscv", "RISCV", "SP", "RA"),
    "aarch64": ("ARCH_ARM64", ("MODE_ARM",), "arm64", "ARM64", "SP", "X30"),
}


class Machine:
    """One emulated core with the image in flash and RAM; hooks are set before anything runs."""

    def __init__(self, settings: dict[str, Any], segments: Segments) -> None:
        self.settings = settings
        arch, modes, module, self._prefix, self._sp, self._lr = FAMILIES[settings["family"]]
        self._constants = importlib.import_module(f"unicorn.{module}_const")
        mode = sum(getattr(unicorn, f"UC_{one}") for one in modes)
        self.uc = unicorn.Uc(getattr(unicorn, f"UC_{arch}"), mode)
        if model := settings["model"]:
            self.uc.ctl_set_cpu_model(getattr(self._constants, f"UC_CPU_{model}"))
        self.uc.mem_map(FLASH, SIZE)
        self.uc.mem_map(RAM, SIZE)
        if settings["family"] == "aarch64":  # floating point is off after reset
            self.uc.reg_write(self._constants.UC_ARM64_REG_CPACR_EL1, 3 << 20)
        for address, data in segments:
            self.uc.mem_write(address, data)
        self.uc.mem_write(STACK_TOP - STACK_BYTES, bytes([FILL]) * STACK_BYTES)

    def call(self, cir: bytes) -> tuple[float, int]:
        """Run the network once; return its answer and its return code."""
        symbols = self.settings["symbols"]
        thumb = int(self.settings["family"] == "thumb")
        self.uc.mem_write(symbols["uwb_count_input"], cir)
        self._set(self._sp, STACK_TOP)
        self._set(self._lr, symbols["uwb_count_stop"] | thumb)
        stop = symbols["uwb_count_stop"] & ~thumb
        time_limit_us = self.settings["seconds"] * 1_000_000
        self.uc.emu_start(symbols["uwb_count_call"] | thumb, stop, timeout=time_limit_us)
        if self._get("PC") & ~thumb != stop:
            raise RuntimeError("the network did not return within its limits")
        answer = np.frombuffer(self.uc.mem_read(symbols["uwb_count_output"], 4), "<f4")[0]
        status = np.frombuffer(self.uc.mem_read(symbols["uwb_count_status"], 4), "<i4")[0]
        return float(answer), int(status)

    def stack_bytes(self) -> int:
        """Return how many bytes of the stack no longer hold the pattern."""
        stack = np.frombuffer(self.uc.mem_read(STACK_TOP - STACK_BYTES, STACK_BYTES), np.uint8)
        touched = np.flatnonzero(stack != FILL)
        return 0 if not len(touched) else STACK_BYTES - int(touched[0])

    def _set(self, register: str, value: int) -> None:
        self.uc.reg_write(self._number(register), value)

    def _get(self, register: str) -> int:
        return int(self.uc.reg_read(self._number(register)))

    def _number(self, register: str) -> int:
        return int(getattr(self._constants, f"UC_{self._prefix}_REG_{register}"))


class TracingMachine(Machine):
    """A machine that notes every basic block it enters, up to a number of instructions."""

    def __init__(self, settings: dict[str, Any], segments: Segments) -> None:
        super().__init__(settings, segments)
        self._trace = array.array("q")
        self._budget_bytes = 0
        self.uc.hook_add(unicorn.UC_HOOK_BLOCK, self._enter)

    def trace(self, cir: bytes) -> Words:
        """Run the network once; return the blocks entered as address << 16 | bytes."""
        self._trace = array.array("q")
        self._budget_bytes = self.settings["max_instructions"] * SHORTEST
        self.call(cir)
        return np.array(self._trace, np.int64)

    def _enter(self, uc: Any, address: int, size: int, _data: Any) -> None:
        self._trace.append(address << _BITS | size)
        self._budget_bytes -= size
        if self._budget_bytes < 0:
            uc.emu_stop()


def first_flash_reads(settings: dict[str, Any], segments: Segments, rows: list[bytes]) -> int:
    """Return how often a call reads data from flash, for the first row that can be watched.

    Unicorn 2.1 loses its way on some rows when memory is watched, and then alone; -1 where it
    does on the first few: each try takes a gigabyte of address space, which is limited.
    """
    for cir in rows[:TRIES]:
        with suppress(unicorn.UcError):
            return count_flash_reads(settings, segments, cir)
    return -1


def count_flash_reads(settings: dict[str, Any], segments: Segments, cir: bytes) -> int:
    """Return how often one call reads data from flash."""
    machine, reads = Machine(settings, segments), array.array("q", [0])

    def read(_uc: Any, _kind: int, _address: int, _size: int, _value: int, _data: Any) -> None:
        reads[0] += 1

    machine.uc.hook_add(unicorn.UC_HOOK_MEM_READ, read, begin=FLASH, end=FLASH + SIZE - 1)
    machine.call(cir)
    return reads[0]


def count_rows(
    settings: dict[str, Any], segments: Segments, rows: list[bytes], layers: Words
) -> Words:
    """Return the visits of the first rows: as many as the budget of blocks allows, at least one."""
    machine, counted, left = TracingMachine(settings, segments), [], settings["max_blocks"]
    for row, cir in enumerate(rows):
        trace = machine.trace(cir)
        counted.append(visits(trace, row, layers))
        left -= len(trace)
        if left < len(trace):
            break
    return np.concatenate(counted)


def visits(trace: Words, row: int, layers: Words) -> Words:
    """Return the trace of one row as counts: [m, 6], see the module's text.

    Blocks outside every layer (memcpy, soft float) belong to the layer that was entered last.
    """
    address, size = trace >> _BITS, trace & ((1 << _BITS) - 1)
    taken = np.ones(len(trace), np.int64)
    taken[:-1] = address[1:] != (address + size)[:-1]
    inside = _last_entered(_range_of(address, layers))
    key = trace * (len(layers) + 1) + inside + 1
    unique, where = np.unique(key, return_inverse=True)
    entered = np.bincount(where, minlength=len(unique))
    left = np.bincount(where, weights=taken, minlength=len(unique)).astype(np.int64)
    block, layer = np.divmod(unique, len(layers) + 1)
    columns = (layer - 1, block >> _BITS, block & ((1 << _BITS) - 1), entered, left)
    return np.column_stack([np.full(len(unique), row), *columns]).astype(np.int64)


def _range_of(address: Words, ranges: Words) -> Words:
    """Return the range each address lies in; -1 in front of and between layers, -2 elsewhere.

    Range 0 is the network's own function, where no layer is running.
    """
    order = np.argsort(ranges[:, 0])
    at = np.searchsorted(ranges[order, 0], address, side="right") - 1
    number = order[np.maximum(at, 0)]
    inside = (at >= 0) & (address < ranges[number, 1])
    return np.where(inside, number - 1, -2)


def _last_entered(found: Words) -> Words:
    """Return each entry, those that are -2 replaced by the last one in front of them."""
    known = np.where(found > -2, np.arange(len(found)), -1)
    last = np.maximum.accumulate(known)
    return np.where(last >= 0, found[np.maximum(last, 0)], -1)


def limit(memory_bytes: int, seconds: int) -> None:
    """Limit this process's memory and processor time, where the system can."""
    try:
        import resource
    except ImportError:  # not on Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def run(request: Path, answer: Path) -> None:
    """Emulate every row of a request and write the answer."""
    with np.load(request, allow_pickle=False) as asked:
        content = {name: asked[name] for name in asked.files}
    settings = json.loads(str(content["settings"]))
    limit(settings["memory_bytes"], settings["seconds"])
    numbered = enumerate(content["addresses"].tolist())
    segments = [(address, content[f"segment_{number}"].tobytes()) for number, address in numbered]
    rows = [row.astype("<f4").tobytes() for row in content["inputs"]]
    counted = count_rows(settings, segments, rows, content["layers"])  # first: it has the limit
    machine = Machine(settings, segments)
    outputs, statuses = zip(*(machine.call(row) for row in rows), strict=True)
    np.savez(
        answer,
        outputs=np.array(outputs, np.float32),
        statuses=np.array(statuses),
        visits=counted,
        stack_bytes=machine.stack_bytes(),
        flash_reads=first_flash_reads(settings, segments, rows),
    )


if __name__ == "__main__":
    run(Path(sys.argv[1]), Path(sys.argv[2]))
