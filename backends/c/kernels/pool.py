"""Maximum or mean over a few steps, float or 8 bits."""

from __future__ import annotations

from backends.c.kernels.layer import Context, Layer, target
from backends.c.operators import Pool
from backends.c.text import block, number


def write(pool: Pool, context: Context) -> Layer:
    """Return a pooling as C."""
    made = Layer(pool.kind)
    kind = "float" if pool.dtype == "f32" else "uint8_t"
    steps, channels = pool.y.shape
    made.body = [
        f"const {kind} *const x = {context.pointer(pool.x, made)};",
        *target(kind, context.pointer(pool.y, made)),
    ]
    start, count = _window(pool)
    more = block(f"for (int k = 1; k < {count}; k++)", [_joined(pool, channels)])
    inner = [
        f"const {kind} *const p = x + {_times('from', channels)} + c;",
        f"{kind} r = p[0];",
        *more,
        f"y[{_times('t', channels)} + c] = {_ended(pool, count)};",
    ]
    body = [*start, *block(f"for (int c = 0; c < {channels}; c++)", inner)]
    made.body += block(f"for (int t = 0; t < {steps}; t++)", body)
    return made


def _window(pool: Pool) -> tuple[list[str], str]:
    """Return where the window of step t begins, and C for how many steps of x are in it."""
    first = _times("t", pool.stride)
    last = (pool.y.shape[0] - 1) * pool.stride - pool.before + pool.kernel
    if not pool.before and last <= pool.x.shape[0]:
        return [f"const int from = {first};"], str(pool.kernel)
    begin, width = f"{first} - {pool.before}", pool.x.shape[0]
    end = f"{begin} + {pool.kernel}"
    lines = [
        f"const int from = {begin} > 0 ? {begin} : 0;",
        f"const int to = {end} < {width} ? {end} : {width};",
    ]
    return lines, "to - from"


def _times(name: str, factor: int) -> str:
    return name if factor == 1 else f"{name} * {factor}"


def _joined(pool: Pool, channels: int) -> str:
    value = f"p[{_times('k', channels)}]"
    return f"r = {value} > r ? {value} : r;" if pool.reduction == "max" else f"r += {value};"


def _ended(pool: Pool, count: str) -> str:
    if pool.reduction != "mean":
        return "r"
    return f"r / {number(pool.kernel)}" if pool.padded else f"r / (float)({count})"
