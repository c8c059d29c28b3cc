"""What stands before the layers: vectors of the host, and mathematics without a library."""

from __future__ import annotations

from collections.abc import Iterable

from backends.c.text import block

SINGLE_UNIT = (
    "defined(__GNUC__) && defined(__thumb__) && defined(__ARM_FP) && (__ARM_FP & 4)"
    " && !defined(UWB_SCALAR)"
)  # a Cortex-M with floating point
_NEEDS = {"sigmoid": ("exp",), "tanh": ("exp",)}


def vectors() -> list[str]:
    """Return how many floats this processor adds at once, and how such vectors are used.

    A microcontroller, or a compiler without GNU's vectors, gets plain C99. All widths do the same
    sums in the same order.
    """
    return [
        "#if !defined(__GNUC__) || defined(UWB_SCALAR)",
        "#define UWB_LANES 1",
        "#elif defined(__AVX512F__)",
        "#define UWB_LANES 16",
        "#elif defined(__AVX__)",
        "#define UWB_LANES 8",
        "#elif defined(__SSE2__) || defined(__aarch64__)",
        "#define UWB_LANES 4",
        "#else",
        "#define UWB_LANES 1",
        "#endif",
        *(line for lanes in (4, 8, 16) for line in _vector(lanes)),
    ]


def _vector(lanes: int) -> list[str]:
    size = 4 * lanes
    gnu = f"__attribute__((vector_size({size})))"
    loose = f"__attribute__((vector_size({size}), aligned(4), may_alias))"
    return [
        f"#if UWB_LANES >= {lanes}",
        f"typedef float uwb_f{lanes} {gnu};",
        f"typedef int uwb_i{lanes} {gnu};",
        f"typedef float uwb_u{lanes} {loose};",
        f"#define UWB_LOAD{lanes}(p) ((uwb_f{lanes}) * (const uwb_u{lanes} *)(const void *)(p))",
        f"#define UWB_STORE{lanes}(p, v) (*(uwb_u{lanes} *)(void *)(p) = (v))",
        f"#define UWB_RELU{lanes}(v) "
        f"((uwb_f{lanes})((uwb_i{lanes})(v) & ((v) > (uwb_f{lanes}){{0.0f}})))",
        "#endif",
    ]


def opaque() -> list[str]:
    """Return what hides from GCC that a layer's target and sources are parts of one arena.

    GCC 12.2 for Arm, at any -O, derives the one's address from the other's in a loop that
    transposes, loses sight of what is written, and leaves the whole layer out.
    """
    return [
        "#if defined(__GNUC__) && !defined(__clang__) && !defined(__x86_64__)",
        '#define UWB_OPAQUE(p) __asm__("" : "+r"(p))',
        "#else",
        "#define UWB_OPAQUE(p)",
        "#endif",
    ]


def counting() -> list[str]:
    """Return what keeps layers apart as functions where instructions are counted by layer."""
    return [
        "#ifdef UWB_COUNT",
        "#define UWB_LAYER static __attribute__((noinline)) void",
        "#else",
        "#define UWB_LAYER static void",
        "#endif",
    ]


def helpers(names: Iterable[str]) -> list[str]:
    """Return the functions of these names and what they need, in a fixed order."""
    wanted = set(names)
    for name in tuple(wanted):
        wanted |= set(_NEEDS.get(name, ()))
    known = {
        "exp": _exp,
        "half": _half,
        "sqrt": _sqrt,
        "log": _log,
        "sigmoid": _sigmoid,
        "tanh": _tanh,
    }
    return [line for name, write in known.items() if name in wanted for line in ["", *write()]]


def bits() -> list[str]:
    """Return how a float's bits are read and written."""
    return [
        *block(
            "static inline uint32_t uwb_bits(float x)",
            ["uint32_t n;", "memcpy(&n, &x, sizeof n);", "return n;"],
        ),
        "",
        *block(
            "static inline float uwb_float(uint32_t n)",
            ["float x;", "memcpy(&x, &n, sizeof x);", "return x;"],
        ),
    ]


def _exp() -> list[str]:
    """Return e^x to two units in the last place: 2^n times a polynomial on [-ln2/2, ln2/2].

    The constants are those of the Cephes library (S. Moshier, public domain). Below -87 it gives
    e^-87, above 88 e^88, so that it stays a normal number.
    """
    return block(
        "static inline float uwb_exp(float x)",
        [
            "x = x > -87.0f ? (x < 88.0f ? x : 88.0f) : -87.0f;",
            "const float n = (x * 1.44269504f + 12582912.0f) - 12582912.0f;",
            "const float r = (x - n * 0.693359375f) - n * -2.12194440e-4f;",
            "float p = 1.98756915e-4f;",
            "p = p * r + 1.39819995e-3f;",
            "p = p * r + 8.33345191e-3f;",
            "p = p * r + 4.16657960e-2f;",
            "p = p * r + 1.66666655e-1f;",
            "p = p * r + 5.00000000e-1f;",
            "p = p * (r * r) + r + 1.0f;",
            "return p * uwb_float((uint32_t)((int32_t)n + 127) << 23);",
        ],
    )


def _half() -> list[str]:
    """Return a finite float16 as a float32, exact: by an instruction, or 2^112 times its bits."""
    quick = [
        "float x = uwb_float(n);",
        '__asm__("vcvtb.f32.f16 %0, %1" : "=t"(x) : "t"(x));',
        "return x;",
    ]
    plain = [
        "const float x = uwb_float((uint32_t)(n & 0x7fffu) << 13) * 5.19229686e+33f;",
        "return (n & 0x8000u) ? -x : x;",
    ]
    unit = "#if defined(__GNUC__) && defined(__ARM_FP) && (__ARM_FP & 2) && defined(__thumb__)"
    body = [unit, *quick, "#else", *plain, "#endif"]
    return block("static inline float uwb_half(uint16_t n)", body)


def _log() -> list[str]:
    """Return ln x by Cephes' polynomial (S. Moshier, public domain).

    NaN stays NaN; zero and what is below the normal numbers give the logarithm of the smallest.
    """
    coefficients = (
        *("7.0376836292e-2f", "-1.1514610310e-1f", "1.1676998740e-1f", "-1.2420140846e-1f"),
        *("1.4249322787e-1f", "-1.6668057665e-1f", "2.0000714765e-1f", "-2.4999993993e-1f"),
        "3.3333331174e-1f",
    )
    return block(
        "static inline float uwb_log(float x)",
        [
            *block("if (!(x >= 1.17549435e-38f))", ["return x != x ? x : -87.3365448f;"]),
            "const uint32_t n = uwb_bits(x);",
            "int32_t e = (int32_t)(n >> 23) - 126;",
            "float m = uwb_float((n & 0x007fffffu) | 0x3f000000u);",
            *block("if (m < 0.707106781f)", ["e = e - 1;", "m = m + m;"]),
            "m = m - 1.0f;",
            f"float p = {coefficients[0]};",
            *(f"p = p * m + {value};" for value in coefficients[1:]),
            "const float z = m * m;",
            "const float k = (float)e;",
            "return (m + ((p * m * z - 2.12194440e-4f * k) - 0.5f * z)) + 0.693359375f * k;",
        ],
    )


def _sqrt() -> list[str]:
    """Return the square root rounded to nearest, bit by bit in integers: the same everywhere."""
    return block(
        "static float uwb_sqrt(float x)",
        [
            *block("if (!(x > 1.17549435e-38f))", ["return 0.0f;"]),
            "const uint32_t n = uwb_bits(x);",
            "const int32_t e = (int32_t)(n >> 23) - 127;",
            "const uint32_t m = ((n & 0x007fffffu) | 0x00800000u) << (e & 1);",
            "uint32_t root = 0u, rest = 0u;",
            *block(
                "for (int i = 24; i >= 0; i--)",
                [
                    "const uint32_t pair = i > 12 ? (m >> (2 * (i - 12) - 1)) & 3u",
                    "                    : i == 12 ? (m << 1) & 3u : 0u;",
                    "rest = (rest << 2) | pair;",
                    "const uint32_t trial = (root << 2) | 1u;",
                    "root = root << 1;",
                    *block("if (rest >= trial)", ["rest = rest - trial;", "root = root | 1u;"]),
                ],
            ),
            "const uint32_t rounded = (root + 1u) >> 1;",
            "return uwb_float((uint32_t)((e >> 1) + 126) * 0x00800000u + rounded);",
        ],
    )


def _sigmoid() -> list[str]:
    return block(
        "static inline float uwb_sigmoid(float x)", ["return 1.0f / (1.0f + uwb_exp(-x));"]
    )


def _tanh() -> list[str]:
    return block(
        "static inline float uwb_tanh(float x)",
        ["return 1.0f - 2.0f / (1.0f + uwb_exp(2.0f * x));"],
    )
