"""Whole numbers times a ratio, rounded: by a float, or by integers alone."""

from __future__ import annotations

import numpy as np

from backends.c.kernels.fixed import fixed, is_quick
from backends.c.kernels.layer import Context, Layer
from backends.c.text import number


def scaled(value: str, most: int, ratio: float, zero: int, context: Context, made: Layer) -> str:
    """Return C for zero + round(integer x ratio), the integer at most `most`."""
    plus = f"{zero} + " if zero else ""
    if context.requantise == "fixed":
        [whole], shift = fixed([ratio])
        quick = is_quick(np.array(most), np.array(ratio), shift)
        helper = "scaled_quick" if quick else "scaled"
        made.helpers.add(helper)
        return f"{plus}uwb_{helper}({value}, {whole}, {shift})"
    made.helpers.add("nearest")
    return f"{plus}uwb_nearest((float)({value}) * {number(ratio)})"
