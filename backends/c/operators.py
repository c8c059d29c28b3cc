"""The flat list of typed operators that C is written from.

Everything is for one row. A `Ref` sees part of a buffer as an array, by strides in elements, so
cropping, transposing and broadcasting cost nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Dtype = Literal["f32", "u8"]
Reduction = Literal["sum", "mean", "max", "min"]
Shape = tuple[int, ...]
Array = NDArray[Any]


@dataclass(frozen=True)
class Buffer:
    """A stretch of `size` elements; `name` is set where the caller brings it (a graph input)."""

    size: int
    dtype: Dtype
    name: str | None = None


@dataclass(frozen=True)
class Ref:
    """An array [*shape] within a buffer: element i lies at offset + sum(i x strides)."""

    buffer: int
    shape: Shape
    strides: Shape
    offset: int = 0

    @property
    def size(self) -> int:
        """Return the number of elements."""
        return size_of(self.shape)


@dataclass(frozen=True, eq=False)
class Table:
    """Constants seen as an array by strides; a stride of 0 repeats."""

    values: NDArray[np.float32]
    strides: Shape


@dataclass(frozen=True)
class Input:
    """The element of the loop's n-th input."""

    index: int


@dataclass(frozen=True)
class Result:
    """What the n-th step of the loop's body gave."""

    index: int


@dataclass(frozen=True)
class Number:
    """A constant, the same for all elements."""

    value: float


Argument = Input | Result | Number


@dataclass(frozen=True)
class Step:
    """One function of one element, such as add or sqrt."""

    function: str
    arguments: tuple[Argument, ...]


@dataclass(frozen=True)
class Loop:
    """Float arithmetic element by element over `shape`, kept or reduced to the places of `y`.

    `strides` are those of `y` over `shape`: 0 along axes that are reduced.
    """

    inputs: tuple[Ref | Table, ...]
    y: Ref
    shape: Shape
    strides: Shape
    steps: tuple[Step, ...]
    reduction: Reduction | None = None
    kind: str = "map"


@dataclass(frozen=True, eq=False)
class Convolution:
    """Float maps x [steps, c] -> y [steps, outs]; `weight` [taps, c / groups, outs], `bias` [outs].

    `pads` are rows of zeros before and after x. Each of `groups` equal stretches of outputs reads
    its own stretch of channels. A dense layer is one step of one tap.
    """

    x: Ref
    y: Ref
    weight: NDArray[np.float32]
    bias: NDArray[np.float32]
    stride: int = 1
    dilation: int = 1
    pads: tuple[int, int] = (0, 0)
    relu: bool = False
    groups: int = 1
    kind: str = "conv"


@dataclass(frozen=True)
class Pool:
    """Maximum or mean over `kernel` steps: x [steps, c] -> y [steps, c], float or 8-bit maxima.

    `before` steps of the first window lie before x, and the last may end behind it: neither counts
    for a maximum. A mean divides by `kernel` where `padded`, else by the steps that are there.
    """

    x: Ref
    y: Ref
    reduction: Reduction
    kernel: int
    stride: int
    dtype: Dtype = "f32"
    before: int = 0
    padded: bool = True
    kind: str = "pool"


@dataclass(frozen=True)
class Scale:
    """How a value is held in 8 bits: value = scale x (stored - zero)."""

    scale: float
    zero: int


@dataclass(frozen=True)
class Quantise:
    """Float x -> 8-bit y, element by element over `shape`."""

    x: Ref
    y: Ref
    scale: Scale
    kind: str = "quantise"


@dataclass(frozen=True)
class Dequantise:
    """8-bit x -> float y."""

    x: Ref
    y: Ref
    scale: Scale
    kind: str = "dequantise"


@dataclass(frozen=True, eq=False)
class IntegerConvolution:
    """8-bit maps x [steps, c] -> y [steps, outs]; `weight` int8 [outs, taps, c / groups].

    `bias` int32 [outs]; groups as in `Convolution`. The zero of x is in the bias already.
    y = zero + round(sum x multiplier), or the float sum x multiplier where `zero` is None.
    """

    x: Ref
    y: Ref
    weight: NDArray[np.int8]
    bias: NDArray[np.int32]
    multiplier: NDArray[np.float32]
    zero: int | None
    x_zero: int
    stride: int = 1
    dilation: int = 1
    pads: tuple[int, int] = (0, 0)
    groups: int = 1
    kind: str = "conv"


@dataclass(frozen=True)
class IntegerAdd:
    """8-bit a + b, each of its own scale, over `shape`."""

    a: Ref
    b: Ref
    y: Ref
    a_scale: Scale
    b_scale: Scale
    y_scale: Scale
    kind: str = "add"


@dataclass(frozen=True)
class IntegerMultiply:
    """8-bit a x b, each of its own scale, over `shape`."""

    a: Ref
    b: Ref
    y: Ref
    a_scale: Scale
    b_scale: Scale
    y_scale: Scale
    kind: str = "multiply"


@dataclass(frozen=True)
class IntegerMean:
    """8-bit mean over steps: x [steps, c] -> y [c]."""

    x: Ref
    y: Ref
    x_scale: Scale
    y_scale: Scale
    kind: str = "mean"


@dataclass(frozen=True, eq=False)
class Lookup:
    """8-bit y = table[x], any function of one value."""

    x: Ref
    y: Ref
    table: NDArray[np.uint8]
    kind: str = "lookup"


@dataclass(frozen=True)
class Copy:
    """8-bit y = x, rearranged."""

    x: Ref
    y: Ref
    kind: str = "copy"


@dataclass(frozen=True, eq=False)
class Trees:
    """A sum of trees over x [1, columns]: base + the leaf that each walk from a root ends at.

    A left child follows its node; `feature` holds the column, with the highest bit where NaN goes
    left, or 0x7fff at a leaf, whose value is in `threshold`.
    """

    x: Ref
    y: Ref
    feature: NDArray[np.uint16]
    threshold: NDArray[np.float32]
    right: NDArray[np.uint16]
    root: NDArray[np.uint16]
    base: float
    kind: str = "trees"


Operator = (
    Loop
    | Convolution
    | Pool
    | Quantise
    | Dequantise
    | IntegerConvolution
    | IntegerAdd
    | IntegerMultiply
    | IntegerMean
    | Lookup
    | Copy
    | Trees
)


@dataclass(frozen=True)
class Program:
    """Operators in order, the buffers they use, the named inputs in order, and the result."""

    operators: tuple[Operator, ...]
    buffers: tuple[Buffer, ...]
    inputs: tuple[int, ...]
    result: Ref


def size_of(shape: Shape) -> int:
    """Return the number of elements of an array of that shape."""
    size = 1
    for extent in shape:
        size *= extent
    return size


def reads(operator: Operator) -> tuple[Ref, ...]:
    """Return what an operator reads from buffers."""
    if isinstance(operator, Loop):
        return tuple(item for item in operator.inputs if isinstance(item, Ref))
    if isinstance(operator, IntegerAdd | IntegerMultiply):
        return (operator.a, operator.b)
    return (operator.x,)


def edges(operator: Operator) -> tuple[int, int]:
    """Return how many elements of padding an operator wants before and after what it reads."""
    if isinstance(operator, Convolution | IntegerConvolution):
        channels = operator.x.shape[-1]
        return operator.pads[0] * channels, operator.pads[1] * channels
    return (0, 0)
