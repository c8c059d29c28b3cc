"""Counting an image: emulate recorded rows, price every block, sum by kind and by layer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.measure.counting.compile import Image
from bench.measure.counting.core import Core
from bench.measure.counting.cycles import BlockCost, block_cost
from bench.measure.counting.elf import Contents, read_elf
from bench.measure.counting.emulate import Trace, emulate, layer_functions
from bench.measure.counting.instructions import disassembler
from bench.results import Cycles

Floats = NDArray[np.float32]
OUTSIDE = "between layers"


@dataclass(frozen=True)
class LayerCount:
    """One layer of one call: mean instructions and cycles, helpers it calls included."""

    name: str
    kind: str
    instructions: float
    cycles: Cycles


@dataclass(frozen=True)
class Count:
    """What one call takes on a core: COUNTED by emulation, cycles by table.

    `rows` were run and `counted_rows` of them counted (all, but where a call is very long).
    `instructions` and `cycles` are means over those, `fewest` and `most` the instructions of
    the extreme rows; `kinds` the mean instructions by kind. `ram_bytes` = static + stack; the
    caller's input array is not in it. `outputs_m` float32 [rows], `statuses` [rows].
    `flash_reads`: times data is read from flash in a call (of one row), all loads where the
    emulator could not watch them.
    """

    core: str
    compiler: str
    rows: int
    counted_rows: int
    instructions: float
    fewest: int
    most: int
    cycles: Cycles
    kinds: Mapping[str, float]
    layers: tuple[LayerCount, ...]
    flash_reads: int
    code_bytes: int
    constant_bytes: int
    flash_bytes: int
    static_ram_bytes: int
    stack_bytes: int
    outputs_m: Floats
    statuses: NDArray[np.int64]

    @property
    def ram_bytes(self) -> int:
        """Variables with the arena, and the deepest stack seen."""
        return self.static_ram_bytes + self.stack_bytes


def count_image(image: Image, core: Core, rows: Floats) -> Count:
    """Run CIRs [n, samples] through an image and count. Raises BenchError like `emulate`."""
    if not len(rows):
        raise BenchError("no rows to count: at least one CIR was expected")
    contents = read_elf(image.path)
    trace = emulate(contents, core, rows)
    costs = _costs(contents, core, trace)
    per_row = _per_row(trace, costs)
    counted = len(per_row)
    kinds = _kinds(trace, costs, counted)
    return Count(
        core=core.name,
        compiler=image.compiler,
        rows=len(rows),
        counted_rows=counted,
        instructions=float(per_row.mean()),
        fewest=int(per_row.min()),
        most=int(per_row.max()),
        cycles=_cycles(trace.visits, costs, counted),
        kinds=kinds,
        layers=_layers(contents, trace, costs, counted),
        flash_reads=trace.flash_reads if trace.flash_reads >= 0 else round(kinds.get("load", 0)),
        code_bytes=contents.code_bytes,
        constant_bytes=contents.constant_bytes,
        flash_bytes=contents.flash_bytes,
        static_ram_bytes=contents.static_ram_bytes,
        stack_bytes=trace.stack_bytes,
        outputs_m=trace.outputs_m,
        statuses=trace.statuses,
    )


Costs = Mapping[tuple[int, int], BlockCost]
"""By address and bytes of a block."""
Visits = NDArray[np.int64]


def _costs(contents: Contents, core: Core, trace: Trace) -> Costs:
    """Disassemble and price every block that was entered, once."""
    decode = disassembler(core.family)
    blocks = {(int(address), int(size)) for address, size in trace.visits[:, 2:4]}
    return {
        (address, size): block_cost(decode(_code(contents, address, size), address), core)
        for address, size in blocks
    }


def _code(contents: Contents, address: int, size: int) -> bytes:
    for start, data in contents.segments:
        if start <= address and address + size <= start + len(data):
            return data[address - start : address - start + size]
    raise BenchError(f"the emulator ran code at {address:#x}, outside the image")


def _per_row(trace: Trace, costs: Costs) -> NDArray[np.float64]:
    weights = trace.visits[:, 4] * _sizes(trace.visits, costs)
    return np.bincount(trace.visits[:, 0], weights=weights).astype(np.float64)


def _sizes(visits: Visits, costs: Costs) -> NDArray[np.int64]:
    return np.array([costs[a, s].instructions for a, s in visits[:, 2:4].tolist()], np.int64)


def _cycles(visits: Visits, costs: Costs, rows: int) -> Cycles:
    total = np.zeros(3)
    for address, size, entered, left in visits[:, 2:6].tolist():
        cost = costs[address, size]
        total += entered * cost.cycles + left * cost.taken
    low, typical, high = (total / rows).tolist()
    return Cycles(low, typical, high)


def _kinds(trace: Trace, costs: Costs, rows: int) -> dict[str, float]:
    total: Counter[str] = Counter()
    for address, size, entered in trace.visits[:, 2:5].tolist():
        for kind, number in costs[address, size].kinds.items():
            total[kind] += entered * number
    return {kind: number / rows for kind, number in total.most_common()}


def _layers(contents: Contents, trace: Trace, costs: Costs, rows: int) -> tuple[LayerCount, ...]:
    named = [one.layer or (0, "") for one in layer_functions(contents)]
    labels = {
        -1: (OUTSIDE, "other"),
        **{i: (f"{n:02d}", kind) for i, (n, kind) in enumerate(named)},
    }
    found = []
    for number, (name, kind) in labels.items():
        own = trace.visits[trace.visits[:, 1] == number]
        if len(own):
            instructions = float((own[:, 4] * _sizes(own, costs)).sum() / rows)
            found.append(LayerCount(name, kind, instructions, _cycles(own, costs, rows)))
    return tuple(found)
