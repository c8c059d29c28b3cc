"""Where everything of one REMnet lies in the flat float32 arrays of the fused kernels.

Offsets count float32 values. Feature maps are [time, 16], one row per time step, with a row of
zeros before and after where a convolution reads beyond the ends. Convolution weights are
[kernel, input feature, output feature]. Vectors of 16 come first and odd sizes last, so rows
stay aligned.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from zoo.modules.remnet import FIRST_KERNEL, RemnetModule, ResidualReduction, reduced_length

FloatArray = NDArray[np.float32]

FEATURES = 16  # the kernels' vector width; other widths train in the plain loop
FIRST_ROWS = 8  # the seven taps and one unused row: gradients come eight rows at a time
_SAME = FIRST_KERNEL // 2

_OF_BLOCK = (
    "length",  # time steps in; half as many, rounded up, come out
    # in the parameters
    "residual_weights", "residual_bias", "wide_weights", "wide_bias", "narrow_weights",
    "narrow_bias", "squeeze_weights", "squeeze_bias", "excite_weights", "excite_bias",
    # in the transposed weights
    "residual_back", "even_back", "odd_back", "narrow_back",
    # in the work space: the forward pass, kept for the backward pass
    "input", "residual", "sum", "wide", "narrow", "output", "mean", "hidden", "gate",
)  # fmt: skip
_OF_NET = (
    "samples", "hidden", "final", "parameters", "work",
    "first_weights", "first_bias", "head_weights", "head_bias",
    "signal", "mask", "zeros", "gate_grad", "grad", "residual_grad", "wide_grad", "narrow_grad",
)  # fmt: skip
BLOCK = np.dtype([(name, np.int64) for name in _OF_BLOCK])
NET = np.dtype([(name, np.int64) for name in _OF_NET])


class _Space:
    """Hand out offsets one after the other."""

    def __init__(self) -> None:
        self.size = 0

    def take(self, count: int) -> int:
        start, self.size = self.size, self.size + count
        return start

    def rows(self, count: int) -> int:
        """Offset of row 0 of `count` rows that have a row of zeros on either side."""
        return self.take((count + 2) * FEATURES) + FEATURES

    def padded(self) -> int:
        """Return the size, rounded up to whole rows."""
        return -(-self.size // FEATURES) * FEATURES


@dataclass(frozen=True)
class Layout:
    """The offsets (`net`: one NET record, `blocks`: one BLOCK record per RRM) and array sizes."""

    net: NDArray[np.void]
    blocks: NDArray[np.void]
    parameters: int
    transposed: int
    work: int


def layout_of(module: RemnetModule) -> Layout:
    """Return the layout of `module`, which must have FEATURES features."""
    hidden, count = FEATURES // module.reduction, len(module.rrms)
    net, blocks = np.zeros(1, NET), np.zeros(count, BLOCK)
    net["samples"], net["hidden"] = module.samples, hidden
    net["final"] = reduced_length(module.samples, count)
    for i, block in enumerate(blocks):
        block["length"] = reduced_length(module.samples, i)
    parameters, transposed, work = _Space(), _Space(), _Space()
    _place_parameters(net[0], blocks, hidden, parameters)
    _place_transposed(blocks, transposed)
    _place_work(net[0], blocks, hidden, work)
    net["parameters"], net["work"] = parameters.padded(), work.padded()
    return Layout(net, blocks, parameters.padded(), transposed.padded(), work.padded())


def _place_parameters(net: np.void, blocks: NDArray[np.void], hidden: int, space: _Space) -> None:
    net["first_weights"], net["first_bias"] = space.take(FIRST_ROWS * 16), space.take(16)
    net["head_weights"] = space.take(int(net["final"]) * 16)
    for block in blocks:
        for name, rows in (("residual", 48), ("wide", 48), ("narrow", 16)):
            block[f"{name}_weights"], block[f"{name}_bias"] = space.take(rows * 16), space.take(16)
        block["squeeze_weights"] = space.take(hidden * 16)
        block["excite_weights"], block["excite_bias"] = space.take(hidden * 16), space.take(16)
    for block in blocks:
        block["squeeze_bias"] = space.take(hidden)
    net["head_bias"] = space.take(1)


def _place_transposed(blocks: NDArray[np.void], space: _Space) -> None:
    for block in blocks:
        for name, rows in (("residual", 48), ("even", 16), ("odd", 32), ("narrow", 16)):
            block[f"{name}_back"] = space.take(rows * 16)


def _place_work(net: np.void, blocks: NDArray[np.void], hidden: int, space: _Space) -> None:
    net["zeros"], net["gate_grad"] = space.take(16), space.take(16)
    net["mask"] = space.take(int(net["final"]) * 16)
    output = space.rows(int(net["samples"]))
    for block in blocks:
        length = int(block["length"])
        block["mean"], block["gate"] = space.take(16), space.take(16)
        block["input"], block["residual"] = output, space.take(length * 16)
        block["sum"] = space.rows(length)
        block["wide"], block["narrow"] = (space.take((length + 1) // 2 * 16) for _ in "wn")
        block["output"] = output = space.rows((length + 1) // 2)
    for name in ("grad", "residual_grad", "wide_grad", "narrow_grad"):
        net[name] = space.rows(int(net["samples"]))
    for block in blocks:
        block["hidden"] = space.take(hidden)
    net["signal"] = space.take(int(net["samples"]) + 2 * _SAME + FIRST_ROWS)


def aligned_zeros(*shape: int) -> FloatArray:
    """Return float32 zeros that start on a cache line: vector loads across two cost double."""
    size, line = math.prod(shape) * 4, 64
    raw = np.zeros(size + line, np.uint8)
    start = -raw.ctypes.data % line
    return raw[start : start + size].view(np.float32).reshape(shape)


def flatten(module: RemnetModule, layout: Layout) -> FloatArray:
    """Return the parameters of `module` as one flat array in the kernels' order."""
    flat = aligned_zeros(layout.parameters)
    with torch.no_grad():
        for start, parameter, order in _places(module, layout):
            shape = parameter.permute(order)
            flat[start : start + shape.numel()] = shape.reshape(-1).numpy()
    return flat


def unflatten(flat: FloatArray, module: RemnetModule, layout: Layout) -> None:
    """Write the flat parameters back into `module`."""
    with torch.no_grad():
        for start, parameter, order in _places(module, layout):
            shape = parameter.permute(order)
            piece = torch.from_numpy(flat[start : start + shape.numel()])
            shape.copy_(piece.reshape(shape.shape))


def _places(module: RemnetModule, layout: Layout) -> list[tuple[int, Tensor, tuple[int, ...]]]:
    """Each parameter with its offset and the order of its axes in the flat array."""
    net = layout.net[0]
    head = module.head.weight.view(FEATURES, int(net["final"]))  # flattened features first
    places = _layer(module.first, net, "first", (2, 1, 0))
    places += [(int(net["head_weights"]), head, (1, 0))]
    places += [(int(net["head_bias"]), module.head.bias, (0,))]
    for rrm, block in zip(module.rrms, layout.blocks, strict=True):
        assert isinstance(rrm, ResidualReduction)
        places += _layer(rrm.residual, block, "residual", (2, 1, 0))
        places += _layer(rrm.wide, block, "wide", (2, 1, 0))
        places += _layer(rrm.narrow, block, "narrow", (2, 1, 0))
        places += _layer(rrm.gate.squeeze, block, "squeeze", (0, 1))
        places += _layer(rrm.gate.excite, block, "excite", (1, 0))
    return places


def _layer(
    layer: nn.Conv1d | nn.Linear, record: np.void, name: str, order: tuple[int, ...]
) -> list[tuple[int, Tensor, tuple[int, ...]]]:
    assert layer.bias is not None
    return [
        (int(record[f"{name}_weights"]), layer.weight, order),
        (int(record[f"{name}_bias"]), layer.bias, (0,)),
    ]
