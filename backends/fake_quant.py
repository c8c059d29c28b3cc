"""Fake quantisation: float32 values rounded as the 8-bit graph will round them, with gradients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.fx import GraphModule, Node

from backends.quantise import Range
from backends.rounding import Steps, gradients, rounded
from zoo.inputs import Input
from zoo.training.layout import conv1d, max_pool1d

_aten = torch.ops.aten
_is_dense = _aten.is_non_overlapping_and_dense.default
_INNERMOST = {
    _aten.conv1d.default: conv1d,
    _aten.max_pool1d.default: max_pool1d,
    _aten.view.default: _aten.reshape.default,
}
LAYERS = (_aten.conv1d.default, _aten.conv2d.default, _aten.linear.default)
LARGEST = 255  # unsigned 8 bit
LARGEST_WEIGHT = 127  # signed and symmetric
RANGE_PACE = 10.0  # a range learns this much faster than a weight of the same size


class _RoundToScale(torch.autograd.Function):
    """Round to multiples of a scale within 8 bits; gradients of value and scale.

    The gradient passes straight through the rounding and stops where the range ends; the scale's
    is that of Esser et al., "Learned step size quantization", ICLR 2020.
    """

    @staticmethod
    def forward(ctx: Any, x: Tensor, scale: Tensor, zero_point: int) -> Tensor:
        x = x if _is_dense(x) else x.contiguous()
        ctx.save_for_backward(x, scale)
        ctx.steps = _steps(scale, zero_point)
        out = torch.empty_like(x)
        rounded(_flat(x), ctx.steps, _flat(out))
        return out

    @staticmethod
    def backward(ctx: Any, *given: Tensor) -> tuple[Tensor, Tensor, None]:
        x, scale = ctx.saved_tensors
        through, grad = torch.empty_like(x), given[0]
        if grad.stride() != x.stride():
            grad = torch.empty_like(x).copy_(grad)
        shift = gradients(_flat(x), _flat(grad), ctx.steps, _flat(through))
        return through, shift / scale, None


def _steps(scale: Tensor, zero_point: int) -> Steps:
    found = (1 / scale, scale, -zero_point, LARGEST - zero_point)
    return tuple(np.float32(float(one)) for one in found)


def _flat(x: Tensor) -> NDArray[np.float32]:
    """Return a dense tensor's values [n] as they lie in memory, not copied."""
    values: NDArray[np.float32]
    values = x.detach().as_strided((x.numel(),), (1,), x.storage_offset()).numpy()
    return values


class FakeActivation(nn.Module):
    """Holds a value in unsigned 8 bits: the zero point is fixed, the scale is learnt.

    The learnt parameter is the logarithm of the scale over its start, divided by `RANGE_PACE`.
    """

    start: Tensor

    def __init__(self, start: Range) -> None:
        super().__init__()
        self.register_buffer("start", torch.tensor(start.scale))
        self.zero_point = start.zero_point
        self.growth = nn.Parameter(torch.zeros(()))

    def scale(self) -> Tensor:
        """Return the scale."""
        return self.start * torch.exp(RANGE_PACE * self.growth)

    def learnt(self) -> Range:
        """Return the range as it is now."""
        return Range(self.scale().detach().item(), self.zero_point)

    def forward(self, x: Tensor) -> Tensor:
        """Return x rounded."""
        held: Tensor = _RoundToScale.apply(x, self.scale(), self.zero_point)  # type: ignore[no-untyped-call]
        return held


class FakeWeight(nn.Module):
    """Holds a weight in signed 8 bits, one scale per output channel (the first axis)."""

    def forward(self, weight: Tensor) -> Tensor:
        """Return the weight rounded."""
        largest = weight.detach().flatten(1).abs().amax(1)
        scale = torch.where(largest > 0, largest / LARGEST_WEIGHT, 1.0)
        zero = torch.zeros_like(scale, dtype=torch.int32)
        return torch.fake_quantize_per_channel_affine(
            weight, scale, zero, 0, -LARGEST_WEIGHT, LARGEST_WEIGHT
        )


def fake_quantised(program: GraphModule, ranges: Mapping[str, Range]) -> GraphModule:
    """Let a program round exactly where the 8-bit graph rounds; returns it.

    `ranges` names the values as ONNX does. Raises ValueError where the program lacks one.
    """
    nodes = {node.name: node for node in program.graph.nodes}
    for name, start in ranges.items():
        if name not in nodes:
            raise ValueError(f"cannot learn the range of {name!r}: the program has no such value")
        _insert_after(program, nodes[name], f"fake_{name}", FakeActivation(start))
    for layer in [node for node in nodes.values() if node.target in LAYERS]:
        weight = layer.args[1]
        assert isinstance(weight, Node)
        _insert_after(program, weight, f"fake_{weight.name}", FakeWeight())
    for node in nodes.values():  # the integer form has channels innermost, too: no shuffling
        node.target = _INNERMOST.get(node.target, node.target)
    program.recompile()
    return program


class Fed(nn.Module):
    """A program of named inputs, called with the columns of all of them [n, width]."""

    def __init__(self, program: GraphModule, inputs: Sequence[Input]) -> None:
        super().__init__()
        self.program, self.widths = program, [one.width for one in inputs]

    def forward(self, rows: Tensor) -> Any:
        """Return what the program gives."""
        if len(self.widths) == 1:
            return self.program(rows)
        return self.program(*torch.split(rows, self.widths, 1))


def _insert_after(program: GraphModule, node: Node, name: str, module: nn.Module) -> None:
    program.add_submodule(name, module)
    with program.graph.inserting_after(node):
        rounded = program.graph.call_module(name, (node,))
    node.replace_all_uses_with(rounded, lambda user: user is not rounded)


def learnt_ranges(module: nn.Module) -> dict[str, Range]:
    """Return the ranges of all fake activations, by the value's name."""
    return {
        name.removeprefix("fake_"): found.learnt()
        for name, found in module.named_modules()
        if isinstance(found, FakeActivation)
    }
