"""Float convolutions and dense layers: named accumulators for several steps and outputs."""

from __future__ import annotations

from dataclasses import dataclass

from backends.c.kernels.layer import Context, Layer
from backends.c.operators import Convolution
from backends.c.text import block, floats, indented, table

LANES = (16, 8, 4, 1)


@dataclass(frozen=True)
class Kernel:
    """The sizes that are constants of one kernel.

    Weights are [taps x span, outs]; each step reads `taps` stretches of `span` values, `reach`
    apart; the next step's begin `hop` values later.
    """

    taps: int
    span: int
    reach: int
    outs: int
    hop: int
    relu: bool
    most_steps: int

    @property
    def name(self) -> str:
        """Return the C name."""
        shape = f"{self.taps}x{self.span}_{self.outs}_hop{self.hop}_by{self.most_steps}"
        reach = f"_reach{self.reach}" if self.taps > 1 else ""
        return f"uwb_conv_{shape}{reach}{'_relu' if self.relu else ''}"


def write(layer: Convolution, context: Context) -> Layer:
    """Return a float convolution or dense layer as C."""
    kernel = _kernel(layer)
    made = Layer(layer.kind)
    weight, bias = context.name("weight"), context.name("bias")
    made.tables = [
        table(weight, "float", floats(layer.weight)),
        table(bias, "float", floats(layer.bias)),
    ]
    first = -layer.pads[0] * layer.x.shape[1]
    x, y = context.pointer(layer.x, made), context.pointer(layer.y, made)
    steps = layer.y.shape[0]
    made.body = [f"{kernel.name}({x} - {-first}, {weight}, {bias}, {y}, {steps});"]
    made.kernels[kernel.name] = "\n".join(_function(kernel))
    return made


def _kernel(layer: Convolution) -> Kernel:
    taps, channels, outs = layer.weight.shape
    joined = layer.dilation == 1
    return Kernel(
        taps=1 if joined else taps,
        span=taps * channels if joined else channels,
        reach=0 if joined else layer.dilation * channels,
        outs=outs,
        hop=layer.stride * channels,
        relu=layer.relu,
        most_steps=max(n for n in (1, 2, 4, 8) if n <= layer.y.shape[0]),
    )


def _function(kernel: Kernel) -> list[str]:
    head = f"static void {kernel.name}(const float *x, const float *w, const float *b, float *y,"
    lines = [head, "                       int steps)", "{"]
    if kernel.outs == 1:
        return [*lines, *indented(_dot(kernel)), "}"]
    return [*lines, *_by_lanes(kernel), "}"]


def _by_lanes(kernel: Kernel) -> list[str]:
    """Return the body for every vector width that divides the outputs, the widest first."""
    lines: list[str] = []
    for lanes in [n for n in LANES if kernel.outs % n == 0]:
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
    lines = [f"const float *p = x + t * {kernel.hop};", "const float *q = w + o;"]
    for s in range(steps):
        for v in range(vectors):
            start = _load("b", f"o + {v * lanes}", lanes) if s == 0 else f"a0{v}"
            lines.append(f"{kind} a{s}{v} = {start};")
    lines += _sums(kernel, lanes, vectors, steps)
    for s in range(steps):
        for v in range(vectors):
            value = f"a{s}{v}" if not kernel.relu else _relu(f"a{s}{v}", lanes)
            lines.append(_store(f"y + (t + {s}) * {kernel.outs} + o + {v * lanes}", value, lanes))
    return lines


def _sums(kernel: Kernel, lanes: int, vectors: int, steps: int) -> list[str]:
    kind = f"const uwb_f{lanes}" if lanes > 1 else "const float"
    body = [f"{kind} w{v} = {_load('q', str(v * lanes), lanes)};" for v in range(vectors)]
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
    whole = kernel.span // 8 * 8
    body = ["float total = b[0];", f"const float *p = x + t * {kernel.hop};"]
    body += ["const float *q = w;"]
    inner = _dot_sums(whole)
    inner += [f"total += p[{i}] * q[{i}];" for i in range(whole, kernel.span)]
    if kernel.taps > 1:
        inner += [f"p += {kernel.reach};", f"q += {kernel.span};"]
        inner = block(f"for (int k = 0; k < {kernel.taps}; k++)", inner)
    body += [*inner, f"y[t] = {_relu('total', 1) if kernel.relu else 'total'};"]
    return block("for (int t = 0; t < steps; t++)", body)


def _dot_sums(whole: int) -> list[str]:
    """Return sums over the first `whole` products: vectors, or eight floats by name."""
    if not whole:
        return []
    add = "total += ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7));"
    eight = [f"float s{n} = 0.0f;" for n in range(8)]
    inner = [f"s{n} += p[i + {n}] * q[i + {n}];" for n in range(8)]
    vector = ["uwb_f8 s = UWB_LOAD8(p) * UWB_LOAD8(q);"]
    vector += block(
        f"for (int i = 8; i < {whole}; i += 8)", ["s += UWB_LOAD8(p + i) * UWB_LOAD8(q + i);"]
    )
    vector.append("total += ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));")
    plain = [*eight, *block(f"for (int i = 0; i < {whole}; i += 8)", inner), add]
    return ["#if UWB_LANES >= 8", *block("", vector), "#else", *block("", plain), "#endif"]
