"""8-bit layers but convolutions: quantising, adding, gating, means, tables, copies."""

from __future__ import annotations

import numpy as np

from backends.c.kernels import integer_convolution
from backends.c.kernels.fixed import fixed, is_quick
from backends.c.kernels.layer import Context, Layer, index, merged, target
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
    Ref,
)
from backends.c.text import block, integers, number, table

_LONGEST = 1.0e6  # beyond this a quotient is cut before it is rounded: 8 bits end long before


def write(operator: Operator, context: Context) -> Layer:
    """Return one 8-bit operator as C."""
    if isinstance(operator, IntegerConvolution):
        return integer_convolution.write(operator, context)
    made = Layer(operator.kind)
    if isinstance(operator, IntegerMean):
        made.body = _mean(operator, context, made)
    elif isinstance(operator, IntegerAdd | IntegerMultiply):
        made.body = _pair(operator, context, made)
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
        _source("x", x, context, made),
        *_target(y, context, made),
        *nested(shape, [f"y[{index(to_y)}] = {value.format(index(from_x))};"]),
    ]


def _source(name: str, ref: Ref, context: Context, made: Layer) -> str:
    return f"const {_kind(ref, context)} *const {name} = {context.pointer(ref, made)};"


def _target(ref: Ref, context: Context, made: Layer) -> list[str]:
    return target(_kind(ref, context), context.pointer(ref, made))


def _kind(ref: Ref, context: Context) -> str:
    return "float" if context.program.buffers[ref.buffer].dtype == "f32" else "uint8_t"


def _pair(operator: IntegerAdd | IntegerMultiply, context: Context, made: Layer) -> list[str]:
    refs = (operator.a, operator.b, operator.y)
    shape, (from_a, from_b, to_y) = merged(operator.y.shape, [ref.strides for ref in refs])
    a, b = f"a[{index(from_a)}]", f"b[{index(from_b)}]"
    writer = _sum if isinstance(operator, IntegerAdd) else _product
    value = writer(operator, a, b, context, made)  # type: ignore[arg-type]
    made.helpers.add("narrow")
    return [
        _source("a", operator.a, context, made),
        _source("b", operator.b, context, made),
        *_target(operator.y, context, made),
        *nested(shape, [f"y[{index(to_y)}] = uwb_narrow({value});"]),
    ]


def _sum(op: IntegerAdd, a: str, b: str, context: Context, made: Layer) -> str:
    """Return a sum, of fused products in the runtime's order on x86, or in 64-bit integers."""
    y_scale = np.float32(op.y_scale.scale)
    ratio_a, ratio_b = (
        np.float32(op.a_scale.scale) / y_scale,
        np.float32(op.b_scale.scale) / y_scale,
    )
    if context.requantise == "fixed":
        return _fixed_sum(op, float(ratio_a), float(ratio_b), a, b)
    made.helpers |= {"fused", "nearest"}
    start = _start(op, ratio_a, ratio_b)
    inner = f"uwb_fused((float){b}, {number(float(ratio_b))}, {number(start)})"
    return f"uwb_nearest(uwb_fused((float){a}, {number(float(ratio_a))}, {inner}))"


def _start(op: IntegerAdd, ratio_a: np.float32, ratio_b: np.float32) -> float:
    """Return what the zero points add, rounded in the runtime's order (a fused product last)."""
    of_b = np.float64(np.float32(ratio_b * np.float32(op.b_scale.zero)))
    zeros = np.float32(np.float64(ratio_a) * op.a_scale.zero + of_b)
    return float(np.float32(op.y_scale.zero) - zeros)


def _fixed_sum(op: IntegerAdd, ratio_a: float, ratio_b: float, a: str, b: str) -> str:
    (whole_a, whole_b), shift = fixed([ratio_a, ratio_b])
    start = (op.y_scale.zero << shift) + (1 << (shift - 1))
    start -= whole_a * op.a_scale.zero + whole_b * op.b_scale.zero
    if not 18 <= shift <= 36:
        terms = f"(int64_t){a} * {whole_a} + (int64_t){b} * {whole_b} + INT64_C({start})"
        return f"(int32_t)(({terms}) >> {shift})"
    return _in_halves(a, b, (whole_a, whole_b), start, shift)


def _in_halves(a: str, b: str, wholes: tuple[int, int], start: int, shift: int) -> str:
    """Return the same sum, exact, from products that fit 32 bits: of upper and lower 16 bits."""
    (upper_a, lower_a), (upper_b, lower_b) = (divmod(whole, 1 << 16) for whole in wholes)
    upper, lower = divmod(start, 1 << 16)
    low = f"(int32_t)(({a} * {lower_a}u + {b} * {lower_b}u + {lower}u) >> 16)"
    return f"({a} * {upper_a} + {b} * {upper_b} + {upper} + {low}) >> {shift - 16}"


def _product(op: IntegerMultiply, a: str, b: str, context: Context, made: Layer) -> str:
    ratio = np.float32(op.a_scale.scale) * np.float32(op.b_scale.scale)
    ratio = ratio / np.float32(op.y_scale.scale)
    product = f"({_less(a, op.a_scale.zero)}) * ({_less(b, op.b_scale.zero)})"
    if context.requantise == "fixed":
        return scaled(product, 255 * 255, float(ratio), op.y_scale.zero, context, made)
    made.helpers.add("nearest")
    plus = f" + {number(op.y_scale.zero)}" if op.y_scale.zero else ""  # before it is rounded
    return f"uwb_nearest((float)({product}) * {number(float(ratio))}{plus})"


def _less(value: str, zero: int) -> str:
    return f"{value} - {zero}" if zero else value


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


def _mean(op: IntegerMean, context: Context, made: Layer) -> list[str]:
    steps, channels = op.x.shape
    count = np.float32(steps)
    ratio = np.float32(op.x_scale.scale) / (np.float32(op.y_scale.scale) * count)
    made.helpers.add("narrow")
    value = scaled("sum", 255 * steps, float(ratio), op.y_scale.zero, context, made)
    add = block(f"for (int t = 0; t < {steps}; t++)", [f"sum += x[t * {channels} + c];"])
    body = [f"int32_t sum = {-steps * op.x_scale.zero};", *add, f"y[c] = uwb_narrow({value});"]
    return [
        _source("x", op.x, context, made),
        *_target(op.y, context, made),
        *block(f"for (int c = 0; c < {channels}; c++)", body),
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
