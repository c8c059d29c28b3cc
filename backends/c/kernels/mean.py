"""The mean of rows [w, c] over w: what a squeeze-and-excitation gate starts from."""

from __future__ import annotations

from backends.c.kernels.layer import OPAQUE_Y, Context, Layer
from backends.c.operators import Loop, Ref
from backends.c.text import block, indented, number

LANES = (16, 8, 4, 1)


def write(loop: Loop, context: Context) -> Layer:
    """Return a mean over rows as C: four running sums a channel."""
    made = Layer("mean")
    steps, channels = loop.shape
    x = loop.inputs[0]
    assert isinstance(x, Ref)
    name = f"uwb_mean_{channels}_by{min(steps, 4)}"
    source, target = context.pointer(x, made), context.pointer(loop.y, made)
    made.body = [f"{name}({source}, {target}, {steps}, {number(steps)});"]
    made.kernels[name] = "\n".join(_function(name, channels, steps >= 4))
    return made


def _function(name: str, channels: int, by_four: bool) -> list[str]:
    lines = [f"static void {name}(const float *x, float *y, int steps, float count)", "{"]
    lines.append(f"    {OPAQUE_Y}")
    widths = [n for n in LANES if channels % n == 0]
    for lanes in widths:
        if lanes > 1:
            lines.append(f"#{'if' if lanes == widths[0] else 'elif'} UWB_LANES >= {lanes}")
        elif len(widths) > 1:
            lines.append("#else")
        lines += indented(_channels(channels, lanes, by_four))
    return [*lines, "#endif", "}"] if len(widths) > 1 else [*lines, "}"]


def _channels(channels: int, lanes: int, by_four: bool) -> list[str]:
    kind = f"uwb_f{lanes}" if lanes > 1 else "float"
    sums = range(4 if by_four else 1)
    body = [f"{kind} s{n} = {_at(f'{n * channels} + c', lanes)};" for n in sums]
    body.append(f"int t = {len(sums)};")
    if by_four:
        added = [f"s{n} += {_at(f'(t + {n}) * {channels} + c', lanes)};" for n in sums]
        body += block("for (; t + 4 <= steps; t += 4)", added)
    body += block("for (; t < steps; t++)", [f"s0 += {_at(f't * {channels} + c', lanes)};"])
    total = "((s0 + s1) + (s2 + s3)) / count" if by_four else "s0 / count"
    body.append(f"UWB_STORE{lanes}(y + c, {total});" if lanes > 1 else f"y[c] = {total};")
    return block(f"for (int c = 0; c < {channels}; c += {lanes})", body)


def _at(place: str, lanes: int) -> str:
    return f"UWB_LOAD{lanes}(x + {place})" if lanes > 1 else f"x[{place}]"
