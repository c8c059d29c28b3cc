"""Float convolutions and dense layers: named accumulators for several steps and outputs."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from backends.c.kernels.layer import OPAQUE_Y, Context, Layer, for_groups, shifted
from backends.c.operators import Array, Convolution
from backends.c.text import block, floats, indented, integers, table

LANES = (16, 8, 4, 1)
LONG = 512  # products: from here on sums keep what their additions round off


@dataclass(frozen=True)
class Kernel:
    """The sizes that are constants of one kernel.

    Weights are [taps x span, outs]; each step reads `taps` stretches of `span` values, `reach`
    apart; the next step's begin `hop` values later, and its results `pitch`.
    """

    taps: int
    span: int
    reach: int
    outs: int
    hop: int
    pitch: int
    relu: bool
    most_steps: int
    half: bool = False

    @property
    def name(self) -> str:
        """Return the C name."""
        shape = f"{self.taps}x{self.span}_{self.outs}_hop{self.hop}_by{self.most_steps}"
        reach = f"_reach{self.reach}" if self.taps > 1 else ""
        pitch = f"_pitch{self.pitch}" if self.pitch != self.outs else ""
        ends = f"{'_relu' if self.relu else ''}{'_half' if self.half else ''}"
        return f"uwb_conv_{shape}{reach}{pitch}{ends}"

    @property
    def lanes(self) -> tuple[int, ...]:
        """Return the vector widths it is written for: weights of 16 bits are widened singly."""
        return (1,) if self.half else tuple(n for n in LANES if self.outs % n == 0)


def write(layer: Convolution, context: Context) -> Layer:
    """Return a float convolution or dense layer as C."""
    kernel = _kernel(layer, context.halves and are_halves(layer.weight))
    made = Layer(layer.kind)
    weight, bias = context.name("weight"), context.name("bias")
    weights = by_group(layer)
    made.tables = [
        halves(weight, weights) if kernel.half else table(weight, "float", floats(weights)),
        table(bias, "float", floats(layer.bias)),
    ]
    made.helpers |= {"half"} if kernel.half else set()
    first = layer.pads[0] * layer.x.shape[1]
    x, y = context.pointer(layer.x, made), context.pointer(layer.y, made)
    size = kernel.taps * kernel.span * kernel.outs
    sides = ((f"{x} - {first}", layer.weight.shape[1]), (weight, size))
    places = [*sides, (bias, kernel.outs), (y, kernel.outs)]
    called = ", ".join(shifted(place, layer.groups, step) for place, step in places)
    made.body = for_groups(layer.groups, f"{kernel.name}({called}, {layer.y.shape[0]});")
    made.kernels[kernel.name] = "\n".join(_function(kernel))
    return made


def by_group(layer: Convolution) -> Array:
    """Return the weights [groups, taps, c / groups, outs / groups]."""
    taps, channels, outs = layer.weight.shape
    apart = layer.weight.reshape(taps, channels, layer.groups, outs // layer.groups)
    return np.ascontiguousarray(apart.transpose(2, 0, 1, 3))


def are_halves(values: Array) -> bool:
    """Tell whether all numbers are finite and the same in 16 bits."""
    with np.errstate(over="ignore"):
        narrow = values.astype(np.float16)
    return bool(np.isfinite(narrow).all() and np.array_equal(narrow.astype(np.float32), values))


def halves(name: str, values: Array) -> str:
    """Return a table of numbers as the bits of float16."""
    return table(name, "uint16_t", integers(values.astype(np.float16).view(np.uint16)))


def _kernel(layer: Convolution, half: bool) -> Kernel:
    taps, channels, outs = layer.weight.shape
    every = layer.x.shape[1]
    joined = layer.dilation == 1 and layer.groups == 1
    return Kernel(
        taps=1 if joined else taps,
        span=taps * channels if joined else channels,
        reach=0 if joined else layer.dilation * every,
        outs=outs // layer.groups,
        hop=layer.stride * every,
        pitch=outs,
        relu=layer.relu,
        most_steps=max(n for n in (1, 2, 4, 8) if n <= layer.y.shape[0]),
        half=half,
    )


def _function(kernel: Kernel) -> list[str]:
    kind = "uint16_t" if kernel.half else "float"
    head = f"static void {kernel.name}(const float *x, const {kind} *w, const float *b, float *y,"
    lines = [head, "                       int steps)", "{", f"    {OPAQUE_Y}"]
    if kernel.outs == 1:
        return [*lines, *indented(_dot(kernel)), "}"]
    return [*lines, *_by_lanes(kernel), "}"]


def _by_lanes(kernel: Kernel) -> list[str]:
    """Return the body for every vector width that divides the outputs, the widest first."""
    lines: list[str] = []
    for lanes in kernel.lanes:
        if lanes > 1:
            lines.append(f"#{'elif' if lines else 'if'} UWB_LANES >= {lanes}")
        elif lines:
            lines.append("#else")
        lines += indented(_steps(kernel, lanes))
    return [*lines, "#endif"] if lines[0].startswith("#") else lines


def _tile(kernel: Kernel, lanes: int) -> tuple[int, int]:
    """Return how many vectors of outputs and how many steps are summed at once.

    Four by four fills a Cortex-M4F's registers, two by four those of SSE and AVX2.
    """
    groups = kernel.outs // lanes
    widest = {16: 1, 8: 2, 4: 2, 1: 4}[lanes]
    most = {16: 8, 8: 4, 4: 4, 1: 4}[lanes]
    if kernel.most_steps == 1:
        widest = 4
    vectors = max(n for n in range(1, widest + 1) if groups % n == 0)
    return vectors, min(most, kernel.most_steps)


def _steps(kernel: Kernel, lanes: int) -> list[str]:
    """Return the loop over steps; the last tile ends at the last step, some are done twice."""
    vectors, steps = _tile(kernel, lanes)
    body = _outputs(kernel, lanes, vectors, steps)
    if steps > 1:
        body = [f"t = t + {steps} > steps ? steps - {steps} : t;", *body]
    return block(f"for (int t = 0; t < steps; t += {steps})", body)


def _outputs(kernel: Kernel, lanes: int, vectors: int, steps: int) -> list[str]:
    wide = lanes * vectors
    body = _tile_body(kernel, lanes, vectors, steps)
    if wide == kernel.outs:
        return ["const int o = 0;", *body]
    return block(f"for (int o = 0; o < {kernel.outs}; o += {wide})", body)


def _tile_body(kernel: Kernel, lanes: int, vectors: int, steps: int) -> list[str]:
    kind = f"uwb_f{lanes}" if lanes > 1 else "float"
    weights = "uint16_t" if kernel.half else "float"
    lines = [f"const float *p = x + t * {kernel.hop};", f"const {weights} *q = w + o;"]
    for s in range(steps):
        for v in range(vectors):
            start = _load("b", f"o + {v * lanes}", lanes) if s == 0 else f"a0{v}"
            lines.append(f"{kind} a{s}{v} = {start};")
    lines += _sums(kernel, lanes, vectors, steps)
    for s in range(steps):
        for v in range(vectors):
            value = f"a{s}{v}" if not kernel.relu else _relu(f"a{s}{v}", lanes)
            lines.append(_store(f"y + (t + {s}) * {kernel.pitch} + o + {v * lanes}", value, lanes))
    return lines


def _sums(kernel: Kernel, lanes: int, vectors: int, steps: int) -> list[str]:
    kind = f"const uwb_f{lanes}" if lanes > 1 else "const float"
    loads = [_load("q", str(v * lanes), lanes) for v in range(vectors)]
    loads = [f"uwb_half({load})" for load in loads] if kernel.half else loads
    body = [f"{kind} w{v} = {load};" for v, load in enumerate(loads)]
    for s in range(steps):
        body.append(f"const float x{s} = p[{s * kernel.hop}];")
    for s in range(steps):
        body += [f"a{s}{v} += w{v} * x{s};" for v in range(vectors)]
    body += [f"q += {kernel.outs};", "p++;"]
    inner = block(f"for (int i = 0; i < {kernel.span}; i++)", body)
    if kernel.taps == 1:
        return inner
    inner.append(f"p += {kernel.reach - kernel.span};")
    return block(f"for (int k = 0; k < {kernel.taps}; k++)", inner)


def _load(pointer: str, place: str, lanes: int) -> str:
    return f"{pointer}[{place}]" if lanes == 1 else f"UWB_LOAD{lanes}({pointer} + {place})"


def _store(pointer: str, value: str, lanes: int) -> str:
    return f"*({pointer}) = {value};" if lanes == 1 else f"UWB_STORE{lanes}({pointer}, {value});"


def _relu(value: str, lanes: int) -> str:
    return f"UWB_RELU{lanes}({value})" if lanes > 1 else f"({value} > 0.0f ? {value} : 0.0f)"


def _dot(kernel: Kernel) -> list[str]:
    """Return one output as eight running sums, the same ones at every vector width."""
    body = ["float total = b[0];", f"const float *p = x + t * {kernel.hop};"]
    weights = "uint16_t" if kernel.half else "float"
    body += [f"const {weights} *q = w;"]
    inner = _products(kernel.span, kernel.half)
    if kernel.taps > 1:
        inner += [f"p += {kernel.reach};", f"q += {kernel.span};"]
        inner = block(f"for (int k = 0; k < {kernel.taps}; k++)", inner)
    place = "t" if kernel.pitch == 1 else f"t * {kernel.pitch}"
    body += [*inner, f"y[{place}] = {_relu('total', 1) if kernel.relu else 'total'};"]
    return block("for (int t = 0; t < steps; t++)", body)


def _products(span: int, half: bool) -> list[str]:
    """Return the addition of `span` products to `total`."""
    whole = span // 8 * 8
    rest = [f"total += p[{i}] * {_weight(str(i), half)};" for i in range(whole, span)]
    return [*_dot_sums(whole, half), *rest]


def _weight(place: str, half: bool) -> str:
    return f"uwb_half(q[{place}])" if half else f"q[{place}]"


def _dot_sums(whole: int, half: bool) -> list[str]:
    """Return sums over the first `whole` products: vectors, or eight floats by name."""
    if not whole:
        return []
    products = [f"p[i + {n}] * {_weight(f'i + {n}', half)}" for n in range(8)]
    keep = whole >= LONG
    added = [_kept(f"{n}", one) if keep else [f"s{n} += {one};"] for n, one in enumerate(products)]
    names = [f"{letter}{n}" for letter in ("se" if keep else "s") for n in range(8)]
    plain = [f"float {name} = 0.0f;" for name in names]
    plain += block(f"for (int i = 0; i < {whole}; i += 8)", list(chain.from_iterable(added)))
    plain += _ends("s{}", "e{}" if keep else "")
    if half:
        return block("", plain)
    vector = _vector_sums(whole, keep)
    return ["#if UWB_LANES >= 8", *block("", vector), "#else", *block("", plain), "#endif"]


def _kept(n: str, product: str, kind: str = "float") -> list[str]:
    """Return an addition to s that keeps in e what it rounds off (Kahan).

    Opposing weights, such as a support vector machine's, let a long sum run up before it cancels.
    """
    return [
        f"const {kind} d{n} = {product} - e{n};",
        f"const {kind} r{n} = s{n} + d{n};",
        f"e{n} = (r{n} - s{n}) - d{n};",
        f"s{n} = r{n};",
    ]


def _vector_sums(whole: int, keep: bool) -> list[str]:
    product = "UWB_LOAD8(p + i) * UWB_LOAD8(q + i)"
    if keep:
        lines = ["uwb_f8 s = {0.0f}, e = {0.0f};"]
        lines += block(f"for (int i = 0; i < {whole}; i += 8)", _kept("", product, "uwb_f8"))
        return [*lines, *_ends("s[{}]", "e[{}]")]
    lines = ["uwb_f8 s = UWB_LOAD8(p) * UWB_LOAD8(q);"]
    lines += block(f"for (int i = 8; i < {whole}; i += 8)", [f"s += {product};"])
    return [*lines, *_ends("s[{}]", "")]


def _ends(sums: str, kept: str) -> list[str]:
    """Return eight sums added to `total`, and what they rounded off taken from it."""
    order = "(({0} + {4}) + ({2} + {6})) + (({1} + {5}) + ({3} + {7}))"
    lines = []
    for name, sign in ((sums, "+"), (kept, "-")):
        if name:
            lines.append(f"total {sign}= {order.format(*(name.format(n) for n in range(8)))};")
    return lines
