"""Where each buffer lies in the one arena, by when it is needed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from backends.c.operators import (
    Buffer,
    Convolution,
    IntegerAdd,
    IntegerConvolution,
    IntegerMultiply,
    Loop,
    Operator,
    Program,
    Ref,
    edges,
    reads,
)

BYTES = {"f32": 4, "u8": 1}
ALIGNMENT = 4


@dataclass(frozen=True)
class Edge:
    """Rows of padding around a buffer: `before` and `after` elements of `value`."""

    buffer: int
    before: int
    after: int
    value: int


@dataclass(frozen=True)
class Plan:
    """`places`: the byte in the arena where each buffer's first element lies.

    `edges`: the padding to write before the operator of that position reads it.
    """

    places: dict[int, int]
    arena_bytes: int
    edges: dict[int, list[Edge]]


@dataclass
class _Block:
    """Buffers that share memory, from the first that is written to the last read."""

    buffers: list[int]
    before: int
    size: int
    after: int
    first: int
    last: int
    offset: int = 0

    @property
    def bytes(self) -> int:
        return -(-(self.before + self.size + self.after) // ALIGNMENT) * ALIGNMENT


def plan(program: Program) -> Plan:
    """Return the plan: blocks by size, each at the lowest place free while it is alive.

    A loop writes over what it reads for the last time, where element meets element; convolutions
    find their padding in memory around their input.
    """
    blocks = _blocks(program)
    placed: list[_Block] = []
    for block in sorted(blocks, key=lambda one: (-one.bytes, one.first)):
        block.offset = _lowest(block, placed)
        placed.append(block)
    places = {b: block.offset + block.before for block in blocks for b in block.buffers}
    size = max((block.offset + block.bytes for block in blocks), default=ALIGNMENT)
    return Plan(places, size, _edges(program))


def _lowest(block: _Block, placed: list[_Block]) -> int:
    rivals = [o for o in placed if o.first <= block.last and block.first <= o.last]
    offset = 0
    for other in sorted(rivals, key=lambda one: one.offset):
        if offset + block.bytes <= other.offset:
            break
        offset = max(offset, other.offset + other.bytes)
    return offset


def _blocks(program: Program) -> list[_Block]:
    first, last = _lifetimes(program)
    owner: dict[int, _Block] = {}
    blocks: list[_Block] = []
    wanted = _wanted_edges(program)
    for index, operator in enumerate(program.operators):
        target = operator.y.buffer
        if target in owner:
            continue
        host = _overwritten(operator, program, last, index, owner)
        if host is None:
            host = _Block([], 0, 0, 0, first[target], last[target])
            blocks.append(host)
        owner[target] = host
        _join(host, target, program.buffers[target], wanted.get(target, (0, 0)), last[target])
    return blocks


def _join(block: _Block, index: int, buffer: Buffer, wanted: tuple[int, int], last: int) -> None:
    width = BYTES[buffer.dtype]
    before = -(-wanted[0] * width // ALIGNMENT) * ALIGNMENT
    block.buffers.append(index)
    block.before, block.after = max(block.before, before), max(block.after, wanted[1] * width)
    block.size, block.last = max(block.size, buffer.size * width), max(block.last, last)


def _lifetimes(program: Program) -> tuple[dict[int, int], dict[int, int]]:
    first: dict[int, int] = {}
    last: dict[int, int] = {}
    for index, operator in enumerate(program.operators):
        first.setdefault(operator.y.buffer, index)
        for ref in (operator.y, *reads(operator)):
            last[ref.buffer] = index
    last[program.result.buffer] = len(program.operators)
    return first, last


def _overwritten(
    operator: Operator,
    program: Program,
    last: dict[int, int],
    index: int,
    owner: dict[int, _Block],
) -> _Block | None:
    """Return the block of an input that may be written over, where there is one."""
    for ref in _replaceable(operator):
        mine, other = program.buffers[operator.y.buffer], program.buffers[ref.buffer]
        same = mine.size == other.size and mine.dtype == other.dtype
        block = owner.get(ref.buffer)
        if block is not None and same and last[ref.buffer] == index and block.last == index:
            return block
    return None


def _replaceable(operator: Operator) -> Iterator[Ref]:
    """Yield inputs read at the very place that is written, and nowhere else."""
    if not isinstance(operator, Loop | IntegerAdd | IntegerMultiply):
        return
    strides = operator.strides if isinstance(operator, Loop) else operator.y.strides
    if isinstance(operator, Loop) and operator.reduction is not None:
        return
    for ref in reads(operator):
        again = [one for one in reads(operator) if one.buffer == ref.buffer]
        whole = ref.offset == operator.y.offset == 0 and ref.size == operator.y.size
        if whole and _same(ref, strides) and all(one == ref for one in again):
            yield ref


def _same(ref: Ref, strides: tuple[int, ...]) -> bool:
    pairs = zip(ref.shape, ref.strides, strides, strict=True)
    return all(extent == 1 or one == other for extent, one, other in pairs)


def _wanted_edges(program: Program) -> dict[int, tuple[int, int]]:
    wanted: dict[int, tuple[int, int]] = {}
    for operator in program.operators:
        before, after = edges(operator)
        for ref in reads(operator):
            old = wanted.get(ref.buffer, (0, 0))
            wanted[ref.buffer] = (max(old[0], before), max(old[1], after))
    return wanted


def _edges(program: Program) -> dict[int, list[Edge]]:
    """Return the padding to write, before the first convolution that wants it."""
    wanted = _wanted_edges(program)
    written: set[int] = set()
    found: dict[int, list[Edge]] = {}
    for index, operator in enumerate(program.operators):
        if not isinstance(operator, Convolution | IntegerConvolution) or not any(operator.pads):
            continue
        buffer = operator.x.buffer
        value = operator.x_zero if isinstance(operator, IntegerConvolution) else 0
        if buffer not in written:
            written.add(buffer)
            found.setdefault(index, []).append(Edge(buffer, *wanted[buffer], value))
    return found
