"""A float ONNX file as operators: layers with weights, and everything around them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from backends.c import shaping
from backends.c.elementwise import (
    apply,
    clip,
    function,
    leaky_relu,
    power,
    reduce,
    reduction,
    several,
)
from backends.c.fuse import fused
from backends.c.operators import Array, Convolution, Pool, Program, Ref
from backends.c.reading import (
    Flattened,
    Handler,
    Node,
    Reading,
    UnknownOperatorError,
    Value,
    load_checked,
    read,
)
from backends.c.trees import tree_ensemble
from backends.c.views import (
    contiguous_strides,
    covers,
    is_contiguous,
    reshaped,
    rows_layout,
    transposed,
)


def read_float(path: Path) -> Program:
    """Return the operators of a float ONNX file, weights in half precision widened.

    Raises ValueError, naming the file: unreadable, hostile, or an operator C is not written for.
    """
    try:
        return fused(read(load_checked(path), FLOAT))
    except ValueError as problem:
        text = str(problem)
        raise ValueError(text if str(path) in text else f"{path}: {text}") from problem


def convolution(reading: Reading, node: Node) -> Value:
    """Conv and FusedConv along time."""
    weight, bias = _weights(reading, node)
    geometry = Geometry.of(node, weight.shape)
    x = conv_input(reading, reading.ref(node.inputs[0]), geometry)
    geometry.check(weight.shape, x.shape[1])
    y = conv_output(reading, x, geometry, weight.shape[0], "f32")
    reading.operators.append(
        Convolution(
            x,
            y,
            np.ascontiguousarray(weight.transpose(2, 1, 0)),
            bias,
            geometry.stride,
            geometry.dilation,
            geometry.pads,
            groups=geometry.groups,
        )
    )
    return _activated(reading, node, as_maps(y))


class Geometry:
    """Kernel, stride, dilation, pads and groups of a convolution along time."""

    def __init__(
        self, kernel: int, stride: int, dilation: int, pads: tuple[int, int], groups: int = 1
    ) -> None:
        self.kernel, self.stride, self.dilation, self.pads = kernel, stride, dilation, pads
        self.groups = groups

    @classmethod
    def of(cls, node: Node, weight_shape: tuple[int, ...]) -> Geometry:
        """Return a node's. Raises ValueError for two dimensions and automatic pads."""
        if len(weight_shape) != 3:
            raise UnknownOperatorError(node.operator, f"over {len(weight_shape) - 2} dimensions")
        if node.get("auto_pad", "NOTSET") not in ("NOTSET", "VALID"):
            raise UnknownOperatorError(node.operator, "with automatic padding")
        stride, dilation = int(node.get("strides", [1])[0]), int(node.get("dilations", [1])[0])
        before, after = (int(pad) for pad in node.get("pads", [0, 0]))
        if min(stride, dilation) < 1 or min(before, after) < 0:
            raise ValueError(f"{node.operator} with stride {stride}, pads {before}, {after}")
        return cls(weight_shape[2], stride, dilation, (before, after), int(node.get("group", 1)))

    def check(self, weight_shape: tuple[int, ...], channels: int) -> None:
        """Raise ValueError where weights [outs, c / groups, taps] do not suit the channels."""
        outs, read = weight_shape[:2]
        if self.groups < 1 or outs % self.groups or read * self.groups != channels:
            what = f"weights {weight_shape} in {self.groups} groups"
            raise ValueError(f"a convolution of {channels} channels by {what}")

    def steps(self, width: int) -> int:
        """Return how many steps come out of `width`. Raises ValueError where there is none."""
        reach = self.dilation * (self.kernel - 1) + 1
        count = (width + sum(self.pads) - reach) // self.stride + 1
        if count < 1 or max(self.pads) >= max(reach, 2):
            raise ValueError(f"a convolution of {self.kernel} taps over {width} steps")
        return count


UNPADDED = Geometry(1, 1, 1, (0, 0))


def conv_input(reading: Reading, maps: Ref, geometry: Geometry) -> Ref:
    """Return maps [1, c, w] as rows [w, c] in a buffer that may have edges, copied if need be."""
    if len(maps.shape) != 3 or maps.shape[0] != 1:
        raise ValueError(f"a convolution over a value of shape {maps.shape}")
    rows = rows_layout(maps)
    if rows is None or (any(geometry.pads) and not _may_have_edges(reading, rows)):
        rows = rows_layout(reading.copied(maps, (0, 1, 2)))
        assert rows is not None
    return rows


def _may_have_edges(reading: Reading, rows: Ref) -> bool:
    buffer = reading.buffers[rows.buffer]
    return buffer.name is None and covers(rows, buffer.size)


def conv_output(reading: Reading, x: Ref, geometry: Geometry, outs: int, dtype: str) -> Ref:
    """Return a new buffer [steps, outs] for what a convolution gives."""
    return reading.new((geometry.steps(x.shape[0]), outs), "u8" if dtype == "u8" else "f32")


def as_maps(rows: Ref) -> Ref:
    """Return rows [w, c] as the maps [1, c, w] that ONNX sees."""
    steps, channels = rows.shape
    return Ref(rows.buffer, (1, channels, steps), (rows.size, 1, channels), rows.offset)


def _weights(reading: Reading, node: Node) -> tuple[Array, Array]:
    weight = reading.array(node.inputs[1]).astype(np.float32)
    if weight.ndim < 2:
        raise ValueError(f"{node.operator} with a weight of shape {weight.shape}")
    if not node.given(2):
        return weight, np.zeros(weight.shape[0], np.float32)
    return weight, reading.array(node.inputs[2]).astype(np.float32).reshape(-1)


def _activated(reading: Reading, node: Node, value: Ref) -> Value:
    """Return a fused layer's activation. Raises UnknownOperatorError for one that is not known."""
    found = str(node.get("activation", ""))
    if found == "LeakyRelu":
        return apply(
            reading, "leaky_relu", [value, float(node.get("activation_params", [0.01])[0])]
        )
    if found not in ("", "Relu", "Sigmoid", "Tanh"):
        raise UnknownOperatorError(node.operator, f"with {found}")
    return apply(reading, found.lower(), [value]) if found else value


def gemm(reading: Reading, node: Node) -> Value:
    """Gemm and FusedGemm with constant weights."""
    weight = reading.array(node.inputs[1]).astype(np.float32)
    if node.get("transA", 0) or weight.ndim != 2:
        raise UnknownOperatorError(node.operator, "of a transposed input")
    weight = (weight.T if node.get("transB", 0) else weight) * np.float32(node.get("alpha", 1.0))
    bias = np.zeros(weight.shape[1], np.float32)
    if node.given(2):
        bias = bias + reading.array(node.inputs[2]).astype(np.float32).reshape(-1)
        bias = bias * np.float32(node.get("beta", 1.0))
    return _activated(reading, node, dense(reading, node.inputs[0], weight, bias))


def matmul(reading: Reading, node: Node) -> Value:
    """MatMul and FusedMatMul with constant weights [in, out]."""
    weight = reading.array(node.inputs[1]).astype(np.float32)
    if weight.ndim != 2:
        raise UnknownOperatorError(node.operator, f"by constants of shape {weight.shape}")
    if any(node.get(turned, 0) for turned in ("transA", "transBatchA", "transBatchB")):
        raise UnknownOperatorError(node.operator, "of a transposed input")
    weight = (weight.T if node.get("transB", 0) else weight) * np.float32(node.get("alpha", 1.0))
    return dense(reading, node.inputs[0], weight, np.zeros(weight.shape[1], np.float32))


def dense(reading: Reading, name: str, weight: Array, bias: Array) -> Ref:
    """Return x [.., n] times weight [n, outs]; weights follow the order x is stored in."""
    x, order = dense_input(reading, name)
    if x.shape[-1] != weight.shape[0] or len(bias) != weight.shape[1]:
        raise ValueError(f"a dense layer {weight.shape} for {x.shape[-1]} values")
    stored = np.ascontiguousarray(weight[order])
    outer = reading.shape(name)[:-1]
    y = reading.new((x.shape[0], weight.shape[1]))
    layer = Convolution(x, y, stored[None], bias.astype(np.float32), kind="dense")
    reading.operators.append(layer)
    return reshaped(y, (*outer, weight.shape[1]))


def dense_input(reading: Reading, name: str) -> tuple[Ref, Array]:
    """Return the input of a dense layer as rows [m, n], and its columns in stored order."""
    value = reading.values[name]
    if isinstance(value, Flattened) and len(value.shape) == 2 and value.shape[0] == 1:
        places = _places(value.source)
        first = int(places.min())
        if places.max() - first + 1 == places.size == np.unique(places).size:
            shape = (1, places.size)
            packed = Ref(value.source.buffer, shape, contiguous_strides(shape), first)
            return packed, np.argsort(places)
    x = reading.ref(name)
    x = x if is_contiguous(x) else reading.packed(x)
    return shaping.rows(x), np.arange(x.shape[-1])


def _places(ref: Ref) -> Array:
    """Return where in the buffer each element lies, in the order of the array."""
    places = np.array(ref.offset)
    for extent, stride in zip(ref.shape, ref.strides, strict=True):
        places = places[..., None] + np.arange(extent) * stride
    return places.reshape(-1)


def global_mean(reading: Reading, node: Node) -> Value:
    """GlobalAveragePool of maps [1, c, w]."""
    return reduce(reading, reading.ref(node.inputs[0]), [2], "mean")


def pool(how: str, last: bool = False) -> Handler:
    """Return the handler of MaxPool or AveragePool along time, channels before or after it."""

    def handler(reading: Reading, node: Node) -> Value:
        kernel = [int(size) for size in node.attributes["kernel_shape"]]
        geometry = Geometry.of(node, (1, 1, *kernel))
        if geometry.dilation != 1 or node.get("ceil_mode", 0):
            raise UnknownOperatorError(node.operator, "with gaps or rounded up")
        maps = reading.ref(node.inputs[0])
        x = conv_input(reading, swapped(maps) if last else maps, UNPADDED)
        dtype = reading.dtype(x)
        if how == "mean" and dtype == "u8":
            raise UnknownOperatorError(node.operator, "of 8-bit values")
        y = conv_output(reading, x, geometry, x.shape[1], dtype)
        reading.operators.append(
            Pool(
                x,
                y,
                "max" if how == "max" else "mean",
                geometry.kernel,
                geometry.stride,
                dtype,
                geometry.pads[0],
                bool(node.get("count_include_pad", 0)),
            )
        )
        return swapped(as_maps(y)) if last else as_maps(y)

    return handler


def swapped(maps: Ref) -> Ref:
    """Return maps with time and channels in the other order."""
    return transposed(maps, (0, 2, 1))


def batch_norm(reading: Reading, node: Node) -> Value:
    """BatchNormalization at inference, over channels [1, c, ..]."""
    scale, shift, mean, variance = (reading.array(name) for name in node.inputs[1:5])
    factor = scale / np.sqrt(variance + np.float32(node.get("epsilon", 1e-5)))
    rank = len(reading.shape(node.inputs[0]))
    shape = (1, -1, *[1] * (rank - 2))
    value = reading.ref(node.inputs[0])
    product = apply(reading, "multiply", [value, factor.reshape(shape)])
    return apply(reading, "add", [product, (shift - mean * factor).reshape(shape)])


SHAPING: Mapping[str, Handler] = {
    "Cast": shaping.cast,
    "Concat": shaping.concat,
    "Constant": shaping.constant_node,
    "Dropout": shaping.identity,
    "Expand": shaping.expand,
    "Flatten": shaping.flatten,
    "Gather": shaping.gather,
    "Identity": shaping.identity,
    "Pad": shaping.pad,
    "Reshape": shaping.reshape,
    "Shape": shaping.shape_of,
    "Slice": shaping.slice_axes,
    "Split": shaping.split,
    "Squeeze": shaping.squeeze,
    "Transpose": shaping.transpose,
    "Unsqueeze": shaping.unsqueeze,
}
FLOAT: Mapping[str, Handler] = {
    **SHAPING,
    "Abs": function("abs", 1),
    "Add": function("add", 2),
    "AveragePool": pool("mean"),
    "BatchNormalization": batch_norm,
    "Clip": clip,
    "Conv": convolution,
    "Div": function("divide", 2),
    "Exp": function("exp", 1),
    "FusedConv": convolution,
    "FusedGemm": gemm,
    "FusedMatMul": matmul,
    "Gemm": gemm,
    "GlobalAveragePool": global_mean,
    "IsNaN": function("is_nan", 1),
    "Greater": function("greater", 2),
    "GreaterOrEqual": function("greater_equal", 2),
    "LeakyRelu": leaky_relu,
    "Less": function("less", 2),
    "LessOrEqual": function("less_equal", 2),
    "Log": function("log", 1),
    "MatMul": matmul,
    "Max": several("max"),
    "MaxPool": pool("max"),
    "Min": several("min"),
    "Mul": function("multiply", 2),
    "Neg": function("negate", 1),
    "PRelu": function("leaky_relu", 2),
    "Pow": power,
    "Reciprocal": function("reciprocal", 1),
    "ReduceMax": reduction("max"),
    "ReduceMean": reduction("mean"),
    "ReduceMin": reduction("min"),
    "ReduceSum": reduction("sum"),
    "ReduceSumSquare": reduction("sum", "square"),
    "Relu": function("relu", 1),
    "Sigmoid": function("sigmoid", 1),
    "Sqrt": function("sqrt", 1),
    "Sub": function("subtract", 2),
    "Tanh": function("tanh", 1),
    "TreeEnsembleRegressor": tree_ensemble,
    "Where": function("where", 3),
}
