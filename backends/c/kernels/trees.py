"""A sum of regression trees: from each root, left or right by one comparison a node."""

from __future__ import annotations

from backends.c.kernels.layer import Context, Layer, target
from backends.c.operators import Trees
from backends.c.text import block, floats, integers, number, table


def write(trees: Trees, context: Context) -> Layer:
    """Return the walks as C. A left child follows its node; an unknown value (NaN) is a side."""
    made = Layer(trees.kind)
    names = [context.name(what) for what in ("feature", "threshold", "right", "root")]
    feature, threshold, right, root = names
    made.tables = [
        table(feature, "uint16_t", integers(trees.feature)),
        table(threshold, "float", floats(trees.threshold)),
        table(right, "uint16_t", integers(trees.right)),
        table(root, "uint16_t", integers(trees.root)),
    ]
    step = [
        f"const int f = {feature}[n];",
        "const float v = x[f & 0x7fff];",
        f"const int low = v != v ? f >> 15 : v <= {threshold}[n];",
        f"n = low ? n + 1 : {right}[n];",
    ]
    walk = [
        f"int n = {root}[t];",
        *block(f"while (({feature}[n] & 0x7fff) != 0x7fff)", step),
        f"total += {threshold}[n];",
    ]
    made.body = [
        f"const float *const x = {context.pointer(trees.x, made)};",
        *target("float", context.pointer(trees.y, made)),
        f"float total = {number(trees.base)};",
        *block(f"for (int t = 0; t < {len(trees.root)}; t++)", walk),
        "y[0] = total;",
    ]
    return made
