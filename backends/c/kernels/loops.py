"""Float arithmetic element by element, and its sums, means and extremes along axes."""

from __future__ import annotations

from backends.c.kernels.layer import Context, Layer, index, merged, target
from backends.c.operators import Argument, Input, Loop, Number, Ref, Result, Shape, Step, Table
from backends.c.text import block, floats, number, table

_VARIABLES = "ijkl"
_INFIX = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/"}
_COMPARED = {"greater": ">", "greater_equal": ">=", "less": "<", "less_equal": "<="}
_CALLED = ("exp", "log", "sigmoid", "sqrt", "tanh")
SUM_BLOCK = 32  # sums of sums: the rounding of long sums grows with their depth


def write(loop: Loop, context: Context) -> Layer:
    """Return a loop as C."""
    made = Layer(loop.kind)
    strides = [*(item.strides for item in loop.inputs), loop.strides]
    shape, steps = merged(loop.shape, strides)
    made.body = [
        *(_operand(n, item, context, made) for n, item in enumerate(loop.inputs)),
        *target("float", context.pointer(loop.y, made)),
    ]
    made.helpers |= {step.function for step in loop.steps if step.function in _CALLED}
    if loop.reduction is None:
        made.body += _map(loop, shape, steps)
    else:
        made.body += _reduction(loop, shape, steps)
    return made


def _operand(n: int, item: Ref | Table, context: Context, made: Layer) -> str:
    if isinstance(item, Ref):
        return f"const float *const x{n} = {context.pointer(item, made)};"
    name = context.name(f"table{n}")
    made.tables.append(table(name, "float", floats(item.values)))
    return f"const float *const x{n} = {name};"


def _map(loop: Loop, shape: Shape, strides: list[Shape]) -> list[str]:
    lines, result = body(loop, strides)
    return nested(shape, [*lines, f"y[{index(strides[-1])}] = {result};"])


def nested(shape: Shape, body: list[str], first: int = 0) -> list[str]:
    """Return loops around a body, the first axis outermost."""
    for axis in reversed(range(len(shape))):
        name = _VARIABLES[first + axis]
        body = block(f"for (int {name} = 0; {name} < {shape[axis]}; {name}++)", body)
    return body


def body(loop: Loop, strides: list[Shape]) -> tuple[list[str], str]:
    """Return the statements of a loop's body, and the C for what they give."""
    lines = []
    for n, step in enumerate(loop.steps):
        lines.append(f"const float v{n} = {_call(step, strides)};")
    last: Argument = Result(len(loop.steps) - 1) if loop.steps else Input(0)
    return lines, _argument(last, strides)


def _argument(argument: Argument, strides: list[Shape]) -> str:
    if isinstance(argument, Input):
        return f"x{argument.index}[{index(strides[argument.index])}]"
    return f"v{argument.index}" if isinstance(argument, Result) else number(argument.value)


def _call(step: Step, strides: list[Shape]) -> str:
    name = step.function
    values = [_bracketed(_argument(argument, strides)) for argument in step.arguments]
    if name in _INFIX:
        return f"{values[0]} {_INFIX[name]} {values[1]}"
    if name in _COMPARED:
        return f"{values[0]} {_COMPARED[name]} {values[1]} ? 1.0f : 0.0f"
    if name in _CALLED:
        return f"uwb_{name}({values[0]})"
    return _special(name, values)


def _bracketed(text: str) -> str:
    return f"({text})" if text.startswith("-") else text


def _special(name: str, v: list[str]) -> str:
    forms = {
        "identity": lambda: v[0],
        "square": lambda: f"{v[0]} * {v[0]}",
        "cube": lambda: f"{v[0]} * {v[0]} * {v[0]}",
        "reciprocal": lambda: f"1.0f / {v[0]}",
        "negate": lambda: f"-{v[0]}",
        "abs": lambda: f"{v[0]} < 0.0f ? -{v[0]} : {v[0]}",
        "is_nan": lambda: f"{v[0]} != {v[0]} ? 1.0f : 0.0f",
        "relu": lambda: f"{v[0]} > 0.0f ? {v[0]} : 0.0f",
        "leaky_relu": lambda: f"{v[0]} > 0.0f ? {v[0]} : {v[0]} * {v[1]}",
        "max": lambda: f"{v[0]} > {v[1]} ? {v[0]} : {v[1]}",
        "min": lambda: f"{v[0]} < {v[1]} ? {v[0]} : {v[1]}",
        "where": lambda: f"{v[0]} > 0.5f ? {v[1]} : {v[2]}",
    }
    return forms[name]()


def _reduction(loop: Loop, shape: Shape, strides: list[Shape]) -> list[str]:
    """Return loops over what is kept, and within them those over what is reduced."""
    kept = [axis for axis in range(len(shape)) if strides[-1][axis]]
    along = [axis for axis in range(len(shape)) if not strides[-1][axis]]
    order = [*kept, *along]
    moved = [tuple(one[axis] for axis in order) for one in strides]
    outer, inner = (tuple(shape[axis] for axis in axes) for axes in (kept, along))
    lines, result = body(loop, moved)
    reduced = _accumulated(loop, inner, len(outer), lines, result)
    target = index(moved[-1])
    return nested(outer, [*reduced, f"y[{target}] = {_ended(loop, inner)};"])


def _ended(loop: Loop, inner: Shape) -> str:
    count = 1
    for extent in inner:
        count *= extent
    return f"total / {number(count)}" if loop.reduction == "mean" else "total"


def _accumulated(loop: Loop, inner: Shape, depth: int, lines: list[str], result: str) -> list[str]:
    if loop.reduction in ("max", "min"):
        return _extreme(loop, inner, depth, lines, result)
    if len(inner) == 1 and inner[0] > SUM_BLOCK:
        return _sum_of_sums(inner[0], depth, lines, result)
    summed = nested(inner, [*lines, f"total += {result};"], depth)
    return ["float total = 0.0f;", *summed]


def _extreme(loop: Loop, inner: Shape, depth: int, lines: list[str], result: str) -> list[str]:
    sign, start = (">", "-3.40282347e+38f") if loop.reduction == "max" else ("<", "3.40282347e+38f")
    body = [*lines, f"const float r = {result};", f"total = r {sign} total ? r : total;"]
    return [f"float total = {start};", *nested(inner, body, depth)]


def _sum_of_sums(count: int, depth: int, lines: list[str], result: str) -> list[str]:
    """Return a sum in blocks, each through an array, so that a body of vectors can fill it."""
    name = _VARIABLES[depth]
    fill = block(
        f"for (int {name} = from; {name} < to; {name}++)",
        [*lines, f"part[{name} - from] = {result};"],
    )
    add = block("for (int n = 0; n < to - from; n++)", ["sum += part[n];"])
    body = [
        f"const int to = from + {SUM_BLOCK} < {count} ? from + {SUM_BLOCK} : {count};",
        f"float part[{SUM_BLOCK}];",
        "float sum = 0.0f;",
        *fill,
        *add,
        "total += sum;",
    ]
    outer = block(f"for (int from = 0; from < {count}; from += {SUM_BLOCK})", body)
    return ["float total = 0.0f;", *outer]


def is_mean_of_rows(loop: Loop) -> bool:
    """Tell whether a loop is the plain mean of rows [w, c] over w, kept in a kernel of its own."""
    single = len(loop.inputs) == 1 and isinstance(loop.inputs[0], Ref) and not loop.steps
    if not single or loop.reduction != "mean" or len(loop.shape) != 2:
        return False
    channels = loop.shape[1]
    return loop.strides == (0, 1) and loop.inputs[0].strides == (channels, 1)


def uses_number(argument: Argument) -> bool:
    """Tell whether an argument is a constant."""
    return isinstance(argument, Number)
