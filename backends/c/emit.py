"""An ONNX file as C99: `uwb_predict.c` and `uwb_predict.h`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from backends.c.kernels import (
    convolution,
    integer,
    integer_convolution,
    loops,
    mean,
    pool,
    prelude,
    trees,
)
from backends.c.kernels.layer import Context, Layer
from backends.c.operators import Convolution, Loop, Operator, Pool, Program, Trees
from backends.c.plan import Edge, Plan, plan
from backends.c.text import block, identifiers, indented, number, table

Source = Literal["fp32", "fp16", "int8"]
Requantise = Literal["float", "fixed"]
_KINDS = {"floats": "float", "bytes": "uint8_t"}
CIR = "cir"  # the input that is never unknown
_CPLUSPLUS = ("#ifdef __cplusplus", 'extern "C" {', "#endif")
_NO_FAST_MATH = (
    "#if defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__",
    '#error "compile without -ffast-math: it leaves out the checks for NaN, and sums otherwise"',
    "#endif",
)
LIMIT = 1e9  # counts; DW1000 magnitudes end at 46 341, and no sum overflows below this


@dataclass(frozen=True)
class CSource:
    """C files by name, the bytes of their arena, and their layers' functions in order."""

    files: dict[str, str]
    arena_bytes: int
    layers: list[str]


def generate(onnx_path: Path, precision: Source, requantise: Requantise = "float") -> CSource:
    """Return the C of an ONNX file; the same bytes for the same file.

    `precision` "fp32" takes a float file (weights in half precision are widened), "fp16" the same
    and keeps weights in 16 bits that are the same in them, "int8" one with 8-bit markers;
    `requantise` "fixed" leaves out all floats between 8-bit layers. Raises ValueError, naming the
    file and the operator, for what C cannot be written for.
    """
    return write_program(_program(onnx_path, precision), requantise, precision == "fp16")


def _program(path: Path, precision: Source) -> Program:
    from backends.c.read_float import read_float

    if precision != "int8":
        return read_float(path)
    from backends.c.read_integer import read_integer

    return read_integer(path)


def write_program(
    program: Program, requantise: Requantise = "float", halves: bool = False
) -> CSource:
    """Return operators as C."""
    laid = plan(program)
    names = _input_names(program)
    layers = []
    for position, operator in enumerate(program.operators):
        context = Context(program, laid, names, position, requantise, halves)
        layer = write_layer(operator, context)
        layer.body = [*_edges(laid, position, program), *layer.body]
        layers.append(layer)
    source = _source(program, laid, names, layers)
    files = {"uwb_predict.c": source, "uwb_predict.h": _header(program, laid, names)}
    return CSource(files, laid.arena_bytes, [_name(n, one) for n, one in enumerate(layers)])


def write_layer(operator: Operator, context: Context) -> Layer:
    """Return one operator as C."""
    if isinstance(operator, Loop):
        if loops.is_mean_of_rows(operator):
            return mean.write(operator, context)
        return loops.write(operator, context)
    if isinstance(operator, Convolution):
        return convolution.write(operator, context)
    if isinstance(operator, Pool):
        return pool.write(operator, context)
    if isinstance(operator, Trees):
        return trees.write(operator, context)
    return integer.write(operator, context)


def _input_names(program: Program) -> dict[int, str]:
    names = [str(program.buffers[index].name) for index in program.inputs]
    return dict(zip(program.inputs, identifiers(names), strict=True))


def _name(position: int, layer: Layer) -> str:
    return f"uwb_layer_{position:02d}_{layer.kind}"


def _edges(laid: Plan, position: int, program: Program) -> list[str]:
    lines = []
    for edge in laid.edges.get(position, []):
        dtype = program.buffers[edge.buffer].dtype
        wide, field = (4, "floats") if dtype == "f32" else (1, "bytes")
        first = laid.places[edge.buffer] // wide
        size = program.buffers[edge.buffer].size
        lines += _edge(edge, field, first - edge.before, edge.before)
        lines += _edge(edge, field, first + size, edge.after)
    return lines


def _edge(edge: Edge, field: str, first: int, count: int) -> list[str]:
    """Return C that writes rows of padding: copied, as compilers make a loop a call of memset."""
    if not count:
        return []
    name = _edge_name(field, edge.value)
    return [f"memcpy(uwb_arena.{field} + {first}, {name}, {count} * sizeof {name}[0]);"]


def _edge_name(field: str, value: int) -> str:
    return f"uwb_edge_{field}_{value}"


def _edge_tables(program: Program, laid: Plan) -> list[str]:
    longest: dict[tuple[str, int], int] = {}
    for edge in (edge for edges in laid.edges.values() for edge in edges):
        field = "floats" if program.buffers[edge.buffer].dtype == "f32" else "bytes"
        count = max(edge.before, edge.after, longest.get((field, edge.value), 0))
        longest[field, edge.value] = count
    return [
        table(_edge_name(field, value), _KINDS[field], [_literal(field, value)] * count)
        for (field, value), count in longest.items()
    ]


def _literal(field: str, value: int) -> str:
    return number(value) if field == "floats" else str(value)


def _source(program: Program, laid: Plan, names: dict[int, str], layers: list[Layer]) -> str:
    kernels = {name: text for layer in layers for name, text in layer.kernels.items()}
    helpers = {name for layer in layers for name in layer.helpers}
    parts = [
        "\n".join(_opening(laid, helpers)),
        *_edge_tables(program, laid),
        *kernels.values(),
        *(_function(program, n, layer, names) for n, layer in enumerate(layers)),
        "\n".join(_checks()),
        "\n".join(_predict(program, laid, names, layers)),
    ]
    return "\n\n".join(parts) + "\n"


def _opening(laid: Plan, helpers: set[str]) -> list[str]:
    return [
        "/* Range error of an ultra-wideband measurement, in metres; see uwb_predict.h.",
        "   Written by `bench export`; compile with -ffp-contract=off. */",
        '#include "uwb_predict.h"',
        "#include <stdint.h>",
        "#include <string.h>",
        *_NO_FAST_MATH,
        "",
        *prelude.vectors(),
        *prelude.opaque(),
        *prelude.counting(),
        "",
        "static union {",
        f"    float floats[{laid.arena_bytes // 4}];",
        f"    uint8_t bytes[{laid.arena_bytes}];",
        "} uwb_arena;",
        "",
        *prelude.bits(),
        *prelude.helpers(helpers),
        *_integer_helpers(helpers),
    ]


def _integer_helpers(helpers: set[str]) -> list[str]:
    wanted = integer.needed(helpers)
    known = integer.helpers()
    lines = [line for name, text in known.items() if name in wanted for line in ["", *text]]
    return [*lines, "", *integer_convolution.dsp()] if "narrow" in wanted else lines


def _function(program: Program, position: int, layer: Layer, names: dict[int, str]) -> str:
    taken = [names[i] for i in program.inputs if i in layer.inputs]
    parameters = ", ".join(f"const float *{name}" for name in taken) or "void"
    head = f"UWB_LAYER {_name(position, layer)}({parameters})"
    return "\n".join([*layer.tables, *block(head, layer.body)])


def _checks() -> list[str]:
    """Return the check of samples; a comparison with NaN is false."""
    fits = "(x[i] >= -limit && x[i] <= limit) || (unknown && x[i] != x[i])"
    inner = block(f"if (!({fits}))", ["return 0;"])
    return block(
        "static int uwb_within(const float *x, int count, float limit, int unknown)",
        [*block("for (int i = 0; i < count; i++)", inner), "return 1;"],
    )


def _predict(program: Program, laid: Plan, names: dict[int, str], layers: list[Layer]) -> list[str]:
    body = ["*error_m = 0.0f;"]
    for index in program.inputs:
        size, unknown = program.buffers[index].size, int(names[index] != CIR)
        check = f"if (!uwb_within({names[index]}, {size}, UWB_PREDICT_LIMIT, {unknown}))"
        body += block(check, ["return 1;"])
    for position, layer in enumerate(layers):
        taken = [names[i] for i in program.inputs if i in layer.inputs]
        body.append(f"{_name(position, layer)}({', '.join(taken)});")
    body.append(f"const float result = {_result(program, laid, names)};")
    body += block("if (!uwb_within(&result, 1, 3.40282347e+38f, 0))", ["return 2;"])
    return block(_signature(program, names), [*body, "*error_m = result;", "return 0;"])


def _result(program: Program, laid: Plan, names: dict[int, str]) -> str:
    buffer, offset = program.result.buffer, program.result.offset
    if buffer in names:
        return f"{names[buffer]}[{offset}]"
    return f"uwb_arena.floats[{laid.places[buffer] // 4 + offset}]"


def _signature(program: Program, names: dict[int, str]) -> str:
    parameters = [f"const float {names[i]}[{_size_name(names[i], i, program)}]" for i in names]
    return f"int uwb_predict({', '.join(parameters)}, float *error_m)"


def _size_name(name: str, index: int, program: Program) -> str:
    """Return the macro of an input's size: the first is the radio's samples."""
    first = index == program.inputs[0]
    return "UWB_PREDICT_SAMPLES" if first else f"UWB_PREDICT_{name.upper()}_VALUES"


def _row(program: Program, names: dict[int, str]) -> list[str]:
    """Return a call with all inputs one after another."""
    sizes = [program.buffers[index].size for index in names]
    starts = [sum(sizes[:place]) for place in range(len(sizes))]
    given = ", ".join(f"row + {start}" for start in starts)
    head = "static inline int uwb_predict_row(const float *row, float *error_m)"
    return [
        "/* The same with all inputs one after another. */",
        f"#define UWB_PREDICT_ROW_VALUES {sum(sizes)}",
        *block(head, [f"return uwb_predict({given}, error_m);"]),
    ]


def _what_goes_in(names: dict[int, str]) -> list[str]:
    if CIR not in names.values():
        return ["/* Inputs as REPORT.md lists them."]
    return [
        "/* Magnitudes of the accumulator go in, in counts, from five samples before the",
        "   detected first path on.",
    ]


def _header(program: Program, laid: Plan, names: dict[int, str]) -> str:
    sizes = [
        f"#define {_size_name(name, i, program)} {program.buffers[i].size}"
        for i, name in names.items()
    ]
    lines = [
        "/* Range error of an ultra-wideband measurement, predicted from the radio's channel",
        "   impulse response. C99, one static arena, no library but memcpy. */",
        "#ifndef UWB_PREDICT_H",
        "#define UWB_PREDICT_H",
        "",
        *_CPLUSPLUS,
        "",
        *sizes,
        f"#define UWB_PREDICT_ARENA_BYTES {laid.arena_bytes}",
        f"#define UWB_PREDICT_LIMIT {number(LIMIT)}",
        "",
        *_what_goes_in(names),
        "   The error (measured - true range) comes out, in metres.",
        "   Returns 0; 1 where an input is not finite or beyond +-UWB_PREDICT_LIMIT; 2 where the",
        "   sums overflow; *error_m is 0 then. All zeros are an input like others. Inputs beside",
        "   `cir`, if there are any, may hold NaN for what is not known; REPORT.md has the order",
        "   and the units of their values. */",
        "/* Not reentrant: all calls share the arena. */",
        f"{_signature(program, names)};",
        "",
        *_row(program, names),
        "",
        "#ifdef __cplusplus",
        "}",
        "#endif",
        "#endif",
    ]
    return "\n".join(indented(lines, 0)) + "\n"
