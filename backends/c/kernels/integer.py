"""8-bit layers but convolutions: quantising, adding, gating, means, tables, copies."""

from __future__ import annotations

from backends.c.kernels import integer_convolution, integer_mean, pairs
from backends.c.kernels.layer import Context, Layer, index, merged, source, wrote
from backends.c.kernels.loops import nested
from backends.c.kernels.prelude import SINGLE_UNIT
from backends.c.operators import (
    Copy,
    Dequantise,
    IntegerAdd,
    IntegerConvolution,
    IntegerMean,
    IntegerMultiply,
    Lookup,
    Operator,
    Quantise,
)
from backends.c.text import block, integers, number, table

_LONGEST = 1.0e6  # beyond this a quotient is cut before it is rounded: 8 bits end long before


def write(operator: Operator, context: Context) -> Layer:
    """Return one 8-bit operator as C."""
    if isinstance(operator, IntegerConvolution):
        return integer_convolution.write(operator, context)
    made = Layer(operator.kind)
    if isinstance(operator, IntegerMean):
        made.body = integer_mean.write(operator, context, made)
    elif isinstance(operator, IntegerAdd | IntegerMultiply):
        made.body = pairs.write(operator, context, made)
    else:
        assert isinstance(operator, Quantise | Dequantise | Lookup | Copy)
        made.body = _each(operator, context, made)
    return made


def _each(
    operator: Quantise | Dequantise | Lookup | Copy, context: Context, made: Layer
) -> list[str]:
    x, y = operator.x, operator.y
    value = "x[{}]"
    if isinstance(operator, Quantise):
        made.helpers.add("quantise")
        value = f"uwb_quantise({value} / {number(operator.scale.scale)}, {operator.scale.zero})"
    elif isinstance(operator, Dequantise):
        value = f"(float)({value} - {operator.scale.zero}) * {number(operator.scale.scale)}"
    elif isinstance(operator, Lookup):
        name = context.name("lookup")
        made.tables.append(table(name, "uint8_t", integers(operator.table)))
        value = f"{name}[{value}]"
    shape, (from_x, to_y) = merged(x.shape, [x.strides, y.strides])
    return [
        source("x", x, context, made),
        *wrote(y, context, made),
        *nested(shape, [f"y[{index(to_y)}] = {value.format(index(from_x))};"]),
    ]


def helpers() -> dict[str, list[str]]:
    """Return the functions that 8-bit layers call, by name, in the order they need each other."""
    cut = number(_LONGEST)
    return {
        "nearest": _nearest(),
        "narrow": block(
            "static inline uint8_t uwb_narrow(int32_t n)",
            ["n = n < 0 ? 0 : n;", "return (uint8_t)(n > 255 ? 255 : n);"],
        ),
        "quantise": block(
            "static inline uint8_t uwb_quantise(float v, int32_t zero)",
            [
                f"v = v > -{cut} ? (v < {cut} ? v : {cut}) : -{cut};",
                "return uwb_narrow(zero + uwb_nearest(v));",
            ],
        ),
        "rounded": _rounded(),
        "scaled": _scaled(),
        "scaled_far": _scaled_far(),
        "scaled_quick": _scaled_quick("scaled"),
        "scaled_quick_far": _scaled_quick("scaled_far"),
        "fused": [
            "#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)",
            "#define uwb_fused(a, b, c) __builtin_fmaf((a), (b), (c))",
            "#else",
            "#define uwb_fused(a, b, c) ((float)((double)(a) * (double)(b) + (double)(c)))",
            "#endif",
        ],
    }


def _nearest() -> list[str]:
    """Return rounding to even below 2^22: by an instruction, or by adding 1.5 x 2^23."""
    return block(
        "static inline int32_t uwb_nearest(float v)",
        [
            f"#if {SINGLE_UNIT}",
            '__asm__("vcvtr.s32.f32 %0, %1" : "=t"(v) : "t"(v));',
            "return (int32_t)uwb_bits(v);",
            "#else",
            "return (int32_t)(uwb_bits(v + 12582912.0f) - 0x4b400000u);",
            "#endif",
        ],
    )


def needed(names: set[str]) -> set[str]:
    """Return names of helpers with those that they call."""
    more = {
        "quantise": {"nearest", "narrow"},
        "scaled": {"rounded"},
        "scaled_far": {"scaled", "rounded"},
        "scaled_quick": {"scaled", "rounded"},
        "scaled_quick_far": {"scaled_far", "scaled", "rounded"},
    }
    return names.union(*(more.get(name, set()) for name in names))


def _scaled() -> list[str]:
    """Return n x factor / 2^shift rounded as float32 would: close to a half, every bit counts.

    19 bits of fraction are kept, in which a float's half unit is at most 4 below 256.
    """
    return block(
        "static inline int32_t uwb_scaled(int32_t n, int32_t factor, int shift)",
        [
            "const int64_t t = (int64_t)n * factor;",
            "const int32_t v = (int32_t)(t >> (shift - 19)) + 262144;",
            *block(
                "if (((uint32_t)(v + 8) & 0x7ffffu) < 16u)",
                [
                    "const int32_t r = uwb_single((uint64_t)(t < 0 ? -t : t), shift);",
                    "return t < 0 ? -r : r;",
                ],
            ),
            "return v >> 19;",
        ],
    )


def _scaled_far() -> list[str]:
    """Return the same where sums may go far beyond 8 bits: cut at +-2048 first."""
    return block(
        "static inline int32_t uwb_scaled_far(int32_t n, int32_t factor, int shift)",
        [
            "const int64_t t = (int64_t)n * factor, most = (int64_t)1 << (shift + 11);",
            *block("if (t > most || t < -most)", ["return t < 0 ? -2048 : 2048;"]),
            "return uwb_scaled(n, factor, shift);",
        ],
    )


def _scaled_quick(exact: str) -> list[str]:
    """Return the same for a Cortex-M0+, which multiplies 32 bits to 32 alone: 20 bits first.

    That is wrong by less than 1/256 (see `is_quick`); closer to a half, it is done exactly.
    """
    name = exact.removeprefix("scaled")
    quick = [
        "const int32_t f = factor >> 11, half = 1 << (shift - 24), near = half >> 7;",
        "const uint32_t low = (((uint32_t)n & 0xfffu) * (uint32_t)f) >> 12;",
        "const int32_t v = (n >> 12) * f + (int32_t)low + half;",
        *block(
            "if (((v + near) & (half + half - 1)) >= near + near)", ["return v >> (shift - 23);"]
        ),
    ]
    return block(
        f"static inline int32_t uwb_scaled_quick{name}(int32_t n, int32_t factor, int shift)",
        ["#ifdef __ARM_ARCH_6M__", *quick, "#endif", f"return uwb_{exact}(n, factor, shift);"],
    )


def _rounded() -> list[str]:
    """Return a product rounded to the 24 bits of a float32, then to a whole number."""
    halves = block(
        "static uint64_t uwb_rounded(uint64_t n, int bits)",
        [
            "const uint64_t half = (uint64_t)1 << (bits - 1), rest = n & (half + half - 1);",
            "n = n >> bits;",
            "const int up = rest > half || (rest == half && (n & 1u));",
            "return up ? n + 1u : n;",
        ],
    )
    single = block(
        "static int32_t uwb_single(uint64_t n, int shift)",
        [
            "int drop = 0;",
            *block("while ((n >> drop) >= 16777216u)", ["drop++;"]),
            "n = drop > 0 ? uwb_rounded(n, drop) : n;",
            "return (int32_t)uwb_rounded(n, shift - drop);",
        ],
    )
    return [*halves, "", *single]
