"""Maximum or mean over a few steps, float or 8 bits."""

from __future__ import annotations

from backends.c.kernels.layer import Context, Layer
from backends.c.operators import Pool
from backends.c.text import block, number


def write(pool: Pool, context: Context) -> Layer:
    """Return a pooling as C."""
    made = Layer(pool.kind)
    kind = "float" if pool.dtype == "f32" else "uint8_t"
    steps, channels = pool.y.shape
    made.body = [
        f"const {kind} *const x = {context.pointer(pool.x, made)};",
        f"{kind} *const y = {context.pointer(pool.y, made)};",
    ]
    first = f"const {kind} *const p = x + t * {pool.stride * channels} + c;"
    more = block(f"for (int k = 1; k < {pool.kernel}; k++)", [_joined(pool, channels)])
    last = f"y[t * {channels} + c] = {_ended(pool)};"
    inner = block(
        f"for (int c = 0; c < {channels}; c++)", [first, f"{kind} r = p[0];", *more, last]
    )
    made.body += block(f"for (int t = 0; t < {steps}; t++)", inner)
    return made


def _joined(pool: Pool, channels: int) -> str:
    value = f"p[k * {channels}]"
    return f"r = {value} > r ? {value} : r;" if pool.reduction == "max" else f"r += {value};"


def _ended(pool: Pool) -> str:
    return f"r / {number(pool.kernel)}" if pool.reduction == "mean" else "r"
