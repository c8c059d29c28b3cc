"""What writing one operator gives, and where its operands lie."""

from __future__ import annotations

from dataclasses import dataclass, field

from backends.c.operators import Program, Ref, Shape
from backends.c.plan import Plan
from backends.c.text import block

OPAQUE_Y = "UWB_OPAQUE(y);"


@dataclass
class Layer:
    """One operator as C: tables of constants, the body of its function, and what it calls.

    `helpers` are names of functions of the prelude; `kernels` whole functions by name, written
    once however many layers call them.
    """

    kind: str
    body: list[str] = field(default_factory=list)
    tables: list[str] = field(default_factory=list)
    kernels: dict[str, str] = field(default_factory=dict)
    helpers: set[str] = field(default_factory=set)
    inputs: set[int] = field(default_factory=set)


@dataclass(frozen=True)
class Context:
    """The program, the plan, the C names of its inputs, the layer's number, how 8 bits are made.

    `halves`: weights that are the same in 16 bits are kept so.
    """

    program: Program
    plan: Plan
    names: dict[int, str]
    number: int
    requantise: str = "float"
    halves: bool = False

    def pointer(self, ref: Ref, layer: Layer) -> str:
        """Return C for the address of a ref's first element; notes where it is an input."""
        if ref.buffer in self.names:
            layer.inputs.add(ref.buffer)
            return f"{self.names[ref.buffer]} + {ref.offset}"
        dtype = self.program.buffers[ref.buffer].dtype
        byte = self.plan.places[ref.buffer]
        if dtype == "u8":
            return f"uwb_arena.bytes + {byte + ref.offset}"
        return f"uwb_arena.floats + {byte // 4 + ref.offset}"

    def name(self, what: str) -> str:
        """Return the name of one of the layer's tables."""
        return f"uwb_{what}_{self.number:02d}"


def target(kind: str, place: str) -> list[str]:
    """Return C for `y`, where a layer writes; see `prelude.opaque`."""
    return [f"{kind} *y = {place};", OPAQUE_Y]


def source(name: str, ref: Ref, context: Context, made: Layer) -> str:
    """Return C for `name`, from where a layer reads."""
    return f"const {kind_of(ref, context)} *const {name} = {context.pointer(ref, made)};"


def wrote(ref: Ref, context: Context, made: Layer) -> list[str]:
    """Return C for `y`, where a layer writes a ref."""
    return target(kind_of(ref, context), context.pointer(ref, made))


def kind_of(ref: Ref, context: Context) -> str:
    """Return the C type of what a ref sees."""
    return "float" if context.program.buffers[ref.buffer].dtype == "f32" else "uint8_t"


def shifted(place: str, groups: int, step: int) -> str:
    """Return C for what group g starts at, `step` behind the group before it."""
    return place if groups == 1 else f"{place} + g * {step}"


def for_groups(groups: int, call: str) -> list[str]:
    """Return a call for each group g; one for all where there are none."""
    return [call] if groups == 1 else block(f"for (int g = 0; g < {groups}; g++)", [call])


def merged(shape: Shape, strides: list[Shape]) -> tuple[Shape, list[Shape]]:
    """Return axes joined where every operand goes through both in one stride."""
    axes = [(n, tuple(one[axis] for one in strides)) for axis, n in enumerate(shape) if n != 1]
    joined: list[tuple[int, tuple[int, ...]]] = []
    for extent, steps in axes:
        if joined and all(o == extent * i for o, i in zip(joined[-1][1], steps, strict=True)):
            joined[-1] = (joined[-1][0] * extent, steps)
        else:
            joined.append((extent, steps))
    outer = tuple(extent for extent, _ in joined)
    return outer, [tuple(steps[i] for _, steps in joined) for i in range(len(strides))]


def index(strides: Shape, names: str = "ijkl") -> str:
    """Return C for a place: the sum of loop variables times strides."""
    terms = [
        name if stride == 1 else f"{name} * {stride}"
        for name, stride in zip(names, strides, strict=False)
        if stride
    ]
    return " + ".join(terms) or "0"
