"""8-bit convolutions and dense layers: sums of products in 32 bits, then one rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backends.c.kernels.fixed import fixed, is_quick
from backends.c.kernels.layer import OPAQUE_Y, Context, Layer, for_groups, shifted
from backends.c.operators import Array, IntegerConvolution
from backends.c.text import block, floats, integers, table

MOST = 1 << 21  # sums scaled beyond this are not rounded right by adding 1.5 x 2^23
NEAR = 1 << 11  # up to here 19 bits of fraction have room beside them

_HELPERS = {
    "float": {"nearest", "narrow"},
    "float_far": {"quantise"},
    "fixed": {"scaled", "narrow"},
    "fixed_far": {"scaled_far", "narrow"},
    "fixed_quick": {"scaled_quick", "narrow"},
    "fixed_quick_far": {"scaled_quick_far", "narrow"},
    "result": set[str](),
}


@dataclass(frozen=True)
class Kernel:
    """The constants of one kernel: as `convolution.Kernel`, weights [outs, taps x span]."""

    taps: int
    span: int
    reach: int
    outs: int
    hop: int
    pitch: int
    ending: str
    steps: int

    @property
    def name(self) -> str:
        """Return the C name."""
        shape = f"{self.taps}x{self.span}_{self.outs}_hop{self.hop}_by{self.steps}"
        reach = f"_reach{self.reach}" if self.taps > 1 else ""
        pitch = f"_pitch{self.pitch}" if self.pitch != self.outs else ""
        return f"uwb_conv8_{shape}{reach}{pitch}_{self.ending}"

    @property
    def row(self) -> int:
        """Return how many weights one output has."""
        return self.taps * self.span


def write(layer: IntegerConvolution, context: Context) -> Layer:
    """Return an 8-bit convolution or dense layer as C."""
    _check(layer)
    kernel = _kernel(layer, context)
    made = Layer(layer.kind)
    names = [context.name(what) for what in ("weight", "bias", "scale")]
    made.tables = [
        table(names[0], "int8_t", integers(layer.weight)),
        table(names[1], "int32_t", integers(layer.bias)),
    ]
    ending = _scales(layer, kernel, names[2], made)
    first = layer.pads[0] * layer.x.shape[1]
    x, y = context.pointer(layer.x, made), context.pointer(layer.y, made)
    outs = kernel.outs
    steps = (layer.weight.shape[2], outs * kernel.row, outs, outs, outs)
    places = zip((f"{x} - {first}", *names, y), steps, strict=True)
    called = ", ".join(shifted(place, layer.groups, step) for place, step in places)
    made.body = for_groups(layer.groups, f"{kernel.name}({called}, {layer.y.shape[0]}, {ending});")
    made.kernels[kernel.name] = "\n".join(_function(kernel))
    made.helpers |= _HELPERS[kernel.ending]
    return made


def _check(layer: IntegerConvolution) -> None:
    if _largest_sums(layer).max() >= 1 << 31:
        raise ValueError("a layer whose sums do not fit 32 bits")


def _largest_sums(layer: IntegerConvolution) -> Array:
    weights = np.abs(layer.weight.astype(np.int64)).reshape(len(layer.weight), -1).sum(1)
    sums: Array = weights * 255 + np.abs(layer.bias.astype(np.int64))
    return sums


def _scales(layer: IntegerConvolution, kernel: Kernel, name: str, made: Layer) -> str:
    """Write the multipliers; return the last argument: the zero point, or a shift as well."""
    zero = str(layer.zero or 0)
    if "fixed" not in kernel.ending:
        made.tables.append(table(name, "float", floats(layer.multiplier)))
        return zero
    whole, shift = fixed(layer.multiplier.tolist())
    made.tables.append(table(name, "int32_t", [str(number) for number in whole]))
    return f"{zero}, {shift}"


def _kernel(layer: IntegerConvolution, context: Context) -> Kernel:
    outs, taps, channels = layer.weight.shape
    every = layer.x.shape[1]
    joined = layer.dilation == 1 and layer.groups == 1
    ending = "result" if layer.zero is None else context.requantise
    if ending == "fixed":
        ending = _fixed_ending(layer)
    elif ending == "float" and (_largest_sums(layer) * layer.multiplier).max() >= MOST:
        ending = "float_far"
    return Kernel(
        taps=1 if joined else taps,
        span=taps * channels if joined else channels,
        reach=0 if joined else layer.dilation * every,
        outs=outs // layer.groups,
        hop=layer.stride * every,
        pitch=outs,
        ending=ending,
        steps=min(layer.y.shape[0], 2),
    )


def _fixed_ending(layer: IntegerConvolution) -> str:
    sums, ratios = _largest_sums(layer), layer.multiplier.astype(np.float64)
    _, shift = fixed(layer.multiplier.tolist())
    far = bool((sums * ratios).max() >= NEAR)
    return f"fixed{'_quick' * is_quick(sums, ratios, shift)}{'_far' * far}"


def _function(kernel: Kernel) -> list[str]:
    fixed_point = "fixed" in kernel.ending
    scale = "int32_t" if fixed_point else "float"
    kind = "float" if kernel.ending == "result" else "uint8_t"
    last = ", int shift" if fixed_point else ""
    many = kernel.steps > 1 and kernel.outs > 1 and _at_once(kernel.span // 4 * 4) > 1
    apart = "UWB_APART " if many else ""
    head = [
        f"{apart}static void {kernel.name}(const uint8_t *x, const int8_t *w, const int32_t *b,",
        f"    const {scale} *m, {kind} *y, int steps, int32_t zero{last})",
    ]
    start = [OPAQUE_Y, *(["(void)zero;"] if kernel.ending == "result" else [])]
    return [*head[:1], *block(head[1], [*start, *_steps(kernel)])]


def _steps(kernel: Kernel) -> list[str]:
    body = [f"const uint8_t *const p = x + t * {kernel.hop};"]
    if kernel.steps > 1:
        body = [f"t = t + {kernel.steps} > steps ? steps - {kernel.steps} : t;", *body]
    body += _outputs(kernel)
    return block(f"for (int t = 0; t < steps; t += {kernel.steps})", body)


def _outputs(kernel: Kernel) -> list[str]:
    outs = 2 if kernel.outs % 2 == 0 else 1
    body = [f"const int8_t *const q = w + o * {kernel.row};"]
    for s in range(kernel.steps):
        body += [f"int32_t a{s}{v} = b[o + {v}];" for v in range(outs)]
    body += _sums(kernel, outs)
    for s in range(kernel.steps):
        for v in range(outs):
            target = f"y[(t + {s}) * {kernel.pitch} + o + {v}]"
            body.append(f"{target} = {_ending(kernel, f'a{s}{v}', f'm[o + {v}]')};")
    return block(f"for (int o = 0; o < {kernel.outs}; o += {outs})", body)


def _ending(kernel: Kernel, total: str, factor: str) -> str:
    if kernel.ending == "result":
        return f"(float){total} * {factor}"
    if "fixed" in kernel.ending:
        scaled = "uwb_scaled" + kernel.ending.removeprefix("fixed")
        return f"uwb_narrow(zero + {scaled}({total}, {factor}, shift))"
    if kernel.ending == "float_far":
        return f"uwb_quantise((float){total} * {factor}, zero)"
    return f"uwb_narrow(zero + uwb_nearest((float){total} * {factor}))"


def _sums(kernel: Kernel, outs: int) -> list[str]:
    """Return the sums over the taps: four products an instruction pair with DSP, else one."""
    tap = "k * {}".format
    far = f" + {tap(kernel.reach)}" if kernel.taps > 1 else ""
    row = f" + {tap(kernel.span)}" if kernel.taps > 1 else ""
    fours = kernel.span // 4 * 4
    plain = _products(kernel, outs, 0, far, row)
    lines = plain
    if fours:
        quick = _quads(kernel, outs, fours, far, row)
        small = _by_output(kernel, outs, far, row)
        choice = ["#ifdef UWB_DSP", *quick, "#elif defined(__ARM_ARCH_6M__)", *small]
        lines = [*choice, "#else", *plain, "#endif"]
    if kernel.taps > 1:
        return block(f"for (int k = 0; k < {kernel.taps}; k++)", lines)
    return lines


def _products(kernel: Kernel, outs: int, first: int, far: str, row: str) -> list[str]:
    body = [f"const int32_t x{s} = p[i + {s * kernel.hop}{far}];" for s in range(kernel.steps)]
    body += [f"const int32_t w{v} = q[i + {v * kernel.row}{row}];" for v in range(outs)]
    body += [f"a{s}{v} += x{s} * w{v};" for s in range(kernel.steps) for v in range(outs)]
    return block(f"for (int i = {first}; i < {kernel.span}; i++)", body)


def _by_output(kernel: Kernel, outs: int, far: str, row: str) -> list[str]:
    """Return the sums of one output after another: a Cortex-M0+ has eight registers to hand."""
    unrolled = kernel.span if kernel.span <= 8 else 4 if kernel.span % 4 == 0 else 1
    lines = []
    for v in range(outs):
        body = []
        for n in range(unrolled):
            added = [f"a{s}{v} += r[{n + s * kernel.hop}] * w{n};" for s in range(kernel.steps)]
            body += [f"const int32_t w{n} = u[{n}];", *added]
        body += [f"r += {unrolled};", f"u += {unrolled};"]
        start = [f"const uint8_t *r = p{far};", f"const int8_t *u = q + {v * kernel.row}{row};"]
        end = f"const int8_t *const end = u + {kernel.span};"
        lines += block("", [*start, end, *block("while (u != end)", body)])
    return lines


def _quads(kernel: Kernel, outs: int, fours: int, far: str, row: str) -> list[str]:
    at_once, body = _at_once(fours), []
    for n in range(at_once):
        quad = _quad(kernel, outs, f"{far} + {4 * n}", f"{row} + {4 * n}")
        body += [*block("", quad), '__asm__ volatile("" ::: "memory");'] if at_once > 1 else quad
    lines = block(f"for (int i = 0; i < {fours}; i += {4 * at_once})", body)
    rest = _products(kernel, outs, fours, far, row) if fours < kernel.span else []
    return [*lines, *rest]


def _at_once(fours: int) -> int:
    """Return how many groups of four products a turn of the loop takes."""
    return 2 if fours % 8 == 0 and fours > 8 else 1


def _quad(kernel: Kernel, outs: int, far: str, row: str) -> list[str]:
    body = []
    for s in range(kernel.steps):
        body.append(f"const uint32_t x{s} = uwb_word(p + i + {s * kernel.hop}{far});")
        body.append(f"const uint32_t e{s} = uwb_even(x{s}), o{s} = uwb_odd(x{s});")
    for v in range(outs):
        body.append(f"const uint32_t w{v} = uwb_word(q + i + {v * kernel.row}{row});")
        body.append(f"const uint32_t f{v} = uwb_even_signed(w{v}), g{v} = uwb_odd_signed(w{v});")
        for s in range(kernel.steps):
            body.append(f"a{s}{v} = uwb_dot(e{s}, f{v}, uwb_dot(o{s}, g{v}, a{s}{v}));")
    return body


def dsp() -> list[str]:
    """Return the instructions of a Cortex-M with DSP that work on pairs of 16 bits."""
    unary = {
        "even": "uxtb16 %0, %1",
        "odd": "uxtb16 %0, %1, ror #8",
        "even_signed": "sxtb16 %0, %1",
        "odd_signed": "sxtb16 %0, %1, ror #8",
    }
    lines = [
        "#if defined(__ARM_FEATURE_DSP) && defined(__GNUC__) && !defined(UWB_SCALAR)",
        "#define UWB_DSP",
        *block(
            "static inline uint32_t uwb_word(const void *p)",
            ["uint32_t n;", "memcpy(&n, p, sizeof n);", "return n;"],
        ),
    ]
    for name, text in unary.items():
        body = ["uint32_t r;", f'__asm__("{text}" : "=r"(r) : "r"(n));', "return r;"]
        lines += block(f"static inline uint32_t uwb_{name}(uint32_t n)", body)
    lines += block(
        "static inline int32_t uwb_dot(uint32_t a, uint32_t b, int32_t sum)",
        [
            "int32_t r;",
            '__asm__("smlad %0, %1, %2, %3" : "=r"(r) : "r"(a), "r"(b), "r"(sum));',
            "return r;",
        ],
    )
    return [*lines, "#endif", *_apart()]


def _apart() -> list[str]:
    """Return what keeps a kernel of many sums a function of its own, where pairs are taken.

    GCC 12 takes one that is called once into its caller, unrolls it by its constants and runs out
    of registers: 84 377 cycles instead of 36 040 for 16 outputs of 48 products at 24 steps.
    """
    return [
        "#if defined(UWB_DSP) && !defined(__clang__)",
        "#define UWB_APART __attribute__((noinline, noclone))",
        "#else",
        "#define UWB_APART",
        "#endif",
    ]
