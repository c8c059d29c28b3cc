"""8-bit means over steps."""

from __future__ import annotations

import numpy as np

from backends.c.kernels.layer import Context, Layer, source, wrote
from backends.c.kernels.scaling import scaled
from backends.c.operators import IntegerMean
from backends.c.text import block


def write(op: IntegerMean, context: Context, made: Layer) -> list[str]:
    """Return a mean as C: up to four channels side by side, so that a step's sums are ready."""
    steps, channels = op.x.shape
    ratio = np.float32(op.x_scale.scale) / (np.float32(op.y_scale.scale) * np.float32(steps))
    made.helpers.add("narrow")
    at_once = next(n for n in (4, 2, 1) if channels % n == 0)
    body = [f"int32_t s{n} = {-steps * op.x_scale.zero};" for n in range(at_once)]
    add = [f"s{n} += x[t * {channels} + c + {n}];" for n in range(at_once)]
    body += block(f"for (int t = 0; t < {steps}; t++)", add)
    for n in range(at_once):
        value = scaled(f"s{n}", 255 * steps, float(ratio), op.y_scale.zero, context, made)
        body.append(f"y[c + {n}] = uwb_narrow({value});")
    return [
        source("x", op.x, context, made),
        *wrote(op.y, context, made),
        *block(f"for (int c = 0; c < {channels}; c += {at_once})", body),
    ]
