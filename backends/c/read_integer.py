"""The graph that ONNX Runtime executes for an 8-bit file, as operators.

Read after the optimisations that hold on any processor ("extended"): those of the last level only
lay memory out. Which operators it has depends on the runtime's version, so one that is not known
is refused by name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from backends.c.fuse import fused
from backends.c.operators import (
    Array,
    Dequantise,
    IntegerAdd,
    IntegerConvolution,
    IntegerMean,
    IntegerMultiply,
    Program,
    Quantise,
    Ref,
    Scale,
    Shape,
)
from backends.c.read_float import (
    FLOAT,
    UNPADDED,
    Geometry,
    as_maps,
    conv_input,
    conv_output,
    dense_input,
    pool,
    swapped,
)
from backends.c.reading import (
    Flattened,
    Handler,
    Node,
    Reading,
    UnknownOperatorError,
    Value,
    check,
    load_checked,
    read,
)
from backends.c.tables import concat, lookup, of_constant, scale
from backends.c.views import broadcast, is_contiguous, reshaped, strides_like


def read_integer(path: Path) -> Program:
    """Return the operators that the runtime executes for an 8-bit ONNX file.

    Raises ValueError, naming the file: unreadable, hostile, or an operator C is not written for.
    """
    from backends.ort import executed_graph

    try:
        check(load_checked(path))  # what is hostile is refused before the runtime sees it
        return fused(read(executed_graph(path, "extended"), INTEGER))
    except ValueError as problem:
        text = str(problem)
        raise ValueError(text if str(path) in text else f"{path}: {text}") from problem


def quantise(reading: Reading, node: Node) -> Value:
    """QuantizeLinear to unsigned 8 bits, one scale for all."""
    ref, to = reading.ref(node.inputs[0]), scale(reading, node, 1)
    y = _like(reading, ref)
    reading.operators.append(Quantise(ref, y, to))
    return y


def dequantise(reading: Reading, node: Node) -> Value:
    """DequantizeLinear of a value or of a constant."""
    name = node.inputs[0]
    if reading.constants(name):
        return _widened(reading, node)
    ref = reading.ref(name)
    y = replace(reading.new(ref.shape), strides=strides_like(ref.shape, ref.strides))
    reading.operators.append(Dequantise(ref, y, scale(reading, node, 1)))
    return y


def _widened(reading: Reading, node: Node) -> Array:
    values = reading.array(node.inputs[0]).astype(np.float32)
    factor = reading.array(node.inputs[1]).astype(np.float32)
    zero = reading.array(node.inputs[2]).astype(np.float32) if node.given(2) else np.zeros(())
    axis = int(node.get("axis", 1))
    shape = [1] * values.ndim
    if factor.size > 1:
        shape[axis] = -1
    return np.asarray((values - zero.reshape(shape)) * factor.reshape(shape), np.float32)


def _like(reading: Reading, ref: Ref) -> Ref:
    """Return a new 8-bit buffer, nested like a ref."""
    return replace(reading.new(ref.shape, "u8"), strides=strides_like(ref.shape, ref.strides))


def convolution(reading: Reading, node: Node) -> Value:
    """QLinearConv along time, channels before or after it."""
    weight = _signed(reading, node, 3)
    geometry = Geometry.of(node, weight.shape)
    maps = reading.ref(node.inputs[0])
    last = bool(node.get("channels_last", 0))
    maps = swapped(maps) if last else maps
    x_scale, y_scale = scale(reading, node, 1), scale(reading, node, 6)
    x = conv_input(reading, maps, geometry)
    geometry.check(weight.shape, x.shape[1])
    y = conv_output(reading, x, geometry, weight.shape[0], "u8")
    bias = reading.array(node.inputs[8]) if node.given(8) else np.zeros(len(weight), np.int32)
    reading.operators.append(
        IntegerConvolution(
            x,
            y,
            np.ascontiguousarray(weight.transpose(0, 2, 1)),
            _with_zero(bias, weight, x_scale),
            _multiplier(reading, node, x_scale, y_scale),
            y_scale.zero,
            x_scale.zero,
            geometry.stride,
            geometry.dilation,
            geometry.pads,
            groups=geometry.groups,
        )
    )
    return swapped(as_maps(y)) if last else as_maps(y)


def _signed(reading: Reading, node: Node, place: int) -> Array:
    """Return signed 8-bit weights. Raises UnknownOperatorError for others."""
    weight = reading.array(node.inputs[place])
    zero = reading.array(node.inputs[place + 2])
    if weight.dtype != np.int8 or zero.any():
        raise UnknownOperatorError(node.operator, "with weights that are not signed 8 bits")
    return weight


def _with_zero(bias: Array, weight: Array, x_scale: Scale) -> Array:
    """Return a bias that holds what the zero point of the input adds."""
    sums = weight.reshape(len(weight), -1).astype(np.int64).sum(1)
    added: Array = (bias.astype(np.int64) - x_scale.zero * sums).astype(np.int32)
    return added


def _multiplier(reading: Reading, node: Node, x: Scale, y: Scale | None) -> Array:
    """Return what sums are multiplied by, rounded as the runtime rounds it."""
    factor: Array = reading.array(node.inputs[4]).astype(np.float32).reshape(-1)
    factor = factor * np.float32(x.scale)
    if y is not None:
        factor = factor / np.float32(y.scale)
    rounded: Array = factor.astype(np.float32)
    return rounded


def gemm(reading: Reading, node: Node) -> Value:
    """QGemm: to 8 bits, or to float where it gives the result."""
    if node.get("transA", 0) or node.get("alpha", 1.0) != 1.0:
        raise UnknownOperatorError(node.operator, "of a transposed or scaled input")
    weight = _signed(reading, node, 3)
    weight = weight if node.get("transB", 0) else weight.T
    y_scale = scale(reading, node, 7) if node.given(7) else None
    bias = reading.array(node.inputs[6]) if node.given(6) else np.zeros(len(weight), np.int32)
    return _dense(reading, node, weight, bias, y_scale)


def matmul(reading: Reading, node: Node) -> Value:
    """QLinearMatMul by constants [in, out]."""
    weight = _signed(reading, node, 3)
    if weight.ndim != 2:
        raise UnknownOperatorError(node.operator, f"by constants of shape {weight.shape}")
    bias = np.zeros(weight.shape[1], np.int32)
    return _dense(reading, node, weight.T, bias, scale(reading, node, 6))


def _dense(
    reading: Reading, node: Node, weight: Array, bias: Array, y_scale: Scale | None
) -> Value:
    """Return x [.., in] times int8 weight [out, in]; a float where `y_scale` is None."""
    x_scale = scale(reading, node, 1)
    x, order = dense_input(reading, node.inputs[0])
    if x.shape[-1] != weight.shape[1]:
        raise ValueError(f"a dense layer {weight.shape} for {x.shape[-1]} values")
    outs = len(weight)
    y = reading.new((x.shape[0], outs), "f32" if y_scale is None else "u8")
    reading.operators.append(
        IntegerConvolution(
            x,
            y,
            np.ascontiguousarray(weight[:, order])[:, None, :],
            _with_zero(np.broadcast_to(bias.reshape(-1), (outs,)), weight, x_scale),
            np.broadcast_to(_multiplier(reading, node, x_scale, y_scale), (outs,)).copy(),
            None if y_scale is None else y_scale.zero,
            x_scale.zero,
            kind="dense",
        )
    )
    return reshaped(y, (*reading.shape(node.inputs[0])[:-1], outs))


def add(reading: Reading, node: Node) -> Value:
    """QLinearAdd."""
    if (made := of_constant(reading, node)) is not None:
        return made
    a, b, y = _pair(reading, node)
    a_scale, b_scale, y_scale = (scale(reading, node, place) for place in (1, 4, 6))
    reading.operators.append(IntegerAdd(a, b, y, a_scale, b_scale, y_scale))
    return y


def multiply(reading: Reading, node: Node) -> Value:
    """QLinearMul, of a gate repeated in stretches too."""
    if (made := of_constant(reading, node)) is not None:
        return made
    a_scale, b_scale, y_scale = (scale(reading, node, place) for place in (1, 4, 6))
    gated = _in_stretches(reading, node)
    a, b, y = gated or _pair(reading, node)
    reading.operators.append(IntegerMultiply(a, b, y, a_scale, b_scale, y_scale))
    return y if gated is None else reshaped(y, reading.shape(node.inputs[0]))


def _pair(reading: Reading, node: Node) -> tuple[Ref, Ref, Ref]:
    a, b = reading.ref(node.inputs[0]), reading.ref(node.inputs[3])
    return _to_one_shape(reading, a, b)


def _to_one_shape(reading: Reading, a: Ref, b: Ref) -> tuple[Ref, Ref, Ref]:
    shape: Shape = np.broadcast_shapes(a.shape, b.shape)
    a, b = broadcast(a, shape), broadcast(b, shape)
    whole = a if all(s or n == 1 for s, n in zip(a.strides, shape, strict=True)) else b
    return a, b, _like(reading, whole)


def _in_stretches(reading: Reading, node: Node) -> tuple[Ref, Ref, Ref] | None:
    """Return maps [.., m] and a gate that was repeated to [1, m], both in the gate's own axes."""
    gate = reading.values[node.inputs[3]]
    maps = reading.values[node.inputs[0]]
    if not isinstance(gate, Flattened) or not isinstance(maps, Ref) or not is_contiguous(maps):
        return None
    if gate.source.size != maps.shape[-1]:
        return None
    split = reshaped(maps, (*maps.shape[:-1], *gate.source.shape))
    return _to_one_shape(reading, split, gate.source)


def mean(reading: Reading, node: Node) -> Value:
    """QLinearGlobalAveragePool over time."""
    maps = reading.ref(node.inputs[0])
    last = bool(node.get("channels_last", 0))
    x = conv_input(reading, swapped(maps) if last else maps, UNPADDED)
    channels = x.shape[1]
    y = reading.new((1, 1, channels) if last else (1, channels, 1), "u8")
    x_scale, y_scale = (scale(reading, node, place) for place in (1, 3))
    reading.operators.append(IntegerMean(x, y, x_scale, y_scale))
    return y


INTEGER: Mapping[str, Handler] = {
    **FLOAT,
    "DequantizeLinear": dequantise,
    "NhwcMaxPool": pool("max", last=True),
    "QGemm": gemm,
    "QLinearAdd": add,
    "QLinearConcat": concat,
    "QLinearConv": convolution,
    "QLinearGlobalAveragePool": mean,
    "QLinearLeakyRelu": lookup,
    "QLinearMatMul": matmul,
    "QLinearMul": multiply,
    "QLinearSigmoid": lookup,
    "QuantizeLinear": quantise,
}
