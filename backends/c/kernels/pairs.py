"""Sums and products of two 8-bit arrays.

In floats, kernels of a few elements side by side: a Cortex-M4F waits a cycle wherever the next
instruction needs what the last one gave.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backends.c.kernels.fixed import fixed
from backends.c.kernels.layer import OPAQUE_Y, Context, Layer, index, merged, source, wrote
from backends.c.kernels.loops import nested
from backends.c.kernels.scaling import scaled
from backends.c.operators import IntegerAdd, IntegerMultiply, Shape
from backends.c.text import block, number

Pair = IntegerAdd | IntegerMultiply


@dataclass(frozen=True)
class Laid:
    """A pair's axes, the outermost first, and the strides of both sides and of the result."""

    shape: Shape
    a: Shape
    b: Shape
    y: Shape

    @property
    def is_flat(self) -> bool:
        """Tell whether all three lie in one stretch."""
        return self.a == self.b == self.y == (1,)

    @property
    def is_gate(self) -> bool:
        """Tell whether b is the same at every step, and a and y are rows without gaps."""
        rows = len(self.shape) == 2 and self.a == self.y == (self.shape[1], 1)
        return rows and self.b == (0, 1)


def write(operator: Pair, context: Context, made: Layer) -> list[str]:
    """Return the body of a layer that adds or multiplies."""
    laid = _laid(operator)
    made.helpers.add("narrow")
    lines = [
        source("a", operator.a, context, made),
        source("b", operator.b, context, made),
        *wrote(operator.y, context, made),
    ]
    if context.requantise == "float" and isinstance(operator, IntegerAdd) and laid.is_flat:
        return [*lines, _add_call(operator, laid, made)]
    if context.requantise == "float" and isinstance(operator, IntegerMultiply) and laid.is_gate:
        return [*lines, _gate_call(operator, laid, made)]
    return [*lines, *_each(operator, laid, context, made)]


def _laid(operator: Pair) -> Laid:
    """Return the axes in the order that the result is stored in, joined where they can be."""
    refs = (operator.a, operator.b, operator.y)
    order = sorted(range(len(operator.y.shape)), key=lambda axis: -operator.y.strides[axis])
    strides = [tuple(ref.strides[axis] for axis in order) for ref in refs]
    shape, (a, b, y) = merged(tuple(operator.y.shape[axis] for axis in order), strides)
    return Laid(shape, a, b, y)


def _each(operator: Pair, laid: Laid, context: Context, made: Layer) -> list[str]:
    a, b = f"a[{index(laid.a)}]", f"b[{index(laid.b)}]"
    if isinstance(operator, IntegerAdd):
        value = _sum(operator, a, b, context, made)
    else:
        value = _product(operator, a, b, context, made)
    return nested(laid.shape, [f"y[{index(laid.y)}] = uwb_narrow({value});"])


def _side_by_side(count: int) -> int:
    return next(n for n in (4, 2, 1) if count % n == 0)


def _ratios(op: IntegerAdd) -> tuple[np.float32, np.float32]:
    y_scale = np.float32(op.y_scale.scale)
    return np.float32(op.a_scale.scale) / y_scale, np.float32(op.b_scale.scale) / y_scale


def _add_call(op: IntegerAdd, laid: Laid, made: Layer) -> str:
    """Return the call of a kernel of fused products in the runtime's order on x86."""
    ratio_a, ratio_b = _ratios(op)
    wide = _side_by_side(laid.shape[0])
    name = f"uwb_add8_by{wide}"
    made.helpers |= {"fused", "nearest"}
    made.kernels[name] = "\n".join(_add_kernel(name, wide))
    numbers = (float(ratio_a), float(ratio_b), _start(op, ratio_a, ratio_b))
    return f"{name}(a, b, y, {laid.shape[0]}, {', '.join(map(number, numbers))});"


def _add_kernel(name: str, wide: int) -> list[str]:
    inner = [f"const float s{n} = uwb_fused((float)b[i + {n}], of_b, start);" for n in range(wide)]
    outer = [f"const float t{n} = uwb_fused((float)a[i + {n}], of_a, s{n});" for n in range(wide)]
    body = [*inner, *outer, *_stores([f"t{n}" for n in range(wide)], "i")]
    head = [f"static void {name}(const uint8_t *a, const uint8_t *b, uint8_t *y, int count,"]
    loop = block(f"for (int i = 0; i < count; i += {wide})", body)
    return [*head, *block("    float of_a, float of_b, float start)", [OPAQUE_Y, *loop])]


def _stores(values: list[str], place: str) -> list[str]:
    """Return values rounded and stored, all rounded before the first is stored."""
    lines = [f"const int32_t r{n} = uwb_nearest({value});" for n, value in enumerate(values)]
    return [*lines, *(f"y[{place} + {n}] = uwb_narrow(r{n});" for n in range(len(values)))]


def _gate_call(op: IntegerMultiply, laid: Laid, made: Layer) -> str:
    steps, channels = laid.shape
    wide = _side_by_side(channels)
    zeros = (op.a_scale.zero, op.b_scale.zero, op.y_scale.zero)
    name = f"uwb_gate8_{channels}_by{wide}_zeros{'_'.join(map(str, zeros))}"
    made.helpers.add("nearest")
    made.kernels[name] = "\n".join(_gate_kernel(name, channels, wide, op))
    return f"{name}(a, b, y, {steps}, {number(_ratio(op))});"


def _gate_kernel(name: str, channels: int, wide: int, op: IntegerMultiply) -> list[str]:
    gates = [f"const int32_t g{n} = {_less(f'b[c + {n}]', op.b_scale.zero)};" for n in range(wide)]
    plus = _plus(op)
    body = []
    for n in range(wide):
        value = _less(f"p[{n}]", op.a_scale.zero)
        body.append(f"const float t{n} = (float)(({value}) * g{n}) * ratio{plus};")
    body += [*_stores([f"t{n}" for n in range(wide)], f"t * {channels} + c")]
    body = [f"const uint8_t *const p = a + t * {channels} + c;", *body]
    lines = [*gates, *block("for (int t = 0; t < steps; t++)", body)]
    head = [f"static void {name}(const uint8_t *a, const uint8_t *b, uint8_t *y,"]
    loop = block(f"for (int c = 0; c < {channels}; c += {wide})", lines)
    return [*head, *block("    int steps, float ratio)", [OPAQUE_Y, *loop])]


def _sum(op: IntegerAdd, a: str, b: str, context: Context, made: Layer) -> str:
    """Return a sum, of fused products in the runtime's order on x86, or in 64-bit integers."""
    ratio_a, ratio_b = _ratios(op)
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
    product = f"({_less(a, op.a_scale.zero)}) * ({_less(b, op.b_scale.zero)})"
    if context.requantise == "fixed":
        return scaled(product, 255 * 255, _ratio(op), op.y_scale.zero, context, made)
    made.helpers.add("nearest")
    return f"uwb_nearest((float)({product}) * {number(_ratio(op))}{_plus(op)})"


def _ratio(op: IntegerMultiply) -> float:
    ratio = np.float32(op.a_scale.scale) * np.float32(op.b_scale.scale)
    return float(ratio / np.float32(op.y_scale.scale))


def _plus(op: IntegerMultiply) -> str:
    """Return the zero point that is added before a product is rounded."""
    return f" + {number(op.y_scale.zero)}" if op.y_scale.zero else ""


def _less(value: str, zero: int) -> str:
    return f"{value} - {zero}" if zero else value
