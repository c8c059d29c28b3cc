"""A small convolutional network whose every size can be chosen: what `bench search` searches."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from zoo.modules.remnet import CONV_KERNEL, SqueezeExcitation, reduced_length


@dataclass(frozen=True)
class Shape:
    """The sizes of a `SmallNetwork`.

    `samples` of the CIR, `filters` of `kernel` taps every `stride` samples, then `blocks` that
    halve the time steps, each with attention of `filters / reduction` units (0: none), then
    `hidden` dense units (0: none) and one output.
    """

    samples: int = 128
    filters: int = 12
    kernel: int = 7
    stride: int = 2
    blocks: int = 3
    reduction: int = 0
    hidden: int = 0

    def check(self) -> None:
        """Raise ValueError for a size that is too small, an even kernel, an uneven reduction."""
        if min(self.samples, self.filters, self.stride) < 1 or min(self.blocks, self.hidden) < 0:
            raise ValueError(f"sizes must be positive: {self}")
        if self.kernel < 1 or self.kernel % 2 == 0:
            raise ValueError(f"kernel must be odd and positive, got {self.kernel}")
        if self.reduction < 0 or (self.reduction and self.filters % self.reduction):
            raise ValueError(f"reduction {self.reduction} does not divide {self.filters} filters")

    @property
    def steps(self) -> tuple[int, ...]:
        """Time steps after the first convolution and after each block."""
        first = -(-self.samples // self.stride)
        return tuple(reduced_length(first, number) for number in range(self.blocks + 1))


class Halving(nn.Module):
    """A convolution of stride 2 with its ReLU, and attention where asked for."""

    def __init__(self, filters: int, reduction: int) -> None:
        super().__init__()
        half = CONV_KERNEL // 2
        self.convolution = nn.Conv1d(filters, filters, CONV_KERNEL, stride=2, padding=half)
        self.gate = SqueezeExcitation(filters, reduction) if reduction else nn.Identity()

    def forward(self, x: Tensor) -> Tensor:
        """Map [batch, filters, time] to [batch, filters, ceil(time / 2)]."""
        maps: Tensor = self.gate(torch.relu(self.convolution(x)))
        return maps


class SmallNetwork(nn.Module):
    """Scaled CIR magnitudes [batch, samples] to range errors [batch] in metres.

    REMnet without its residual convolutions and its second path: two thirds of the paper's
    multiplications are in those. Weights start Glorot uniform, drawn from `seed` alone. Raises
    ValueError where the shape is none.
    """

    def __init__(self, shape: Shape, *, dropout: float = 0.0, seed: int = 0) -> None:
        super().__init__()
        shape.check()
        with torch.random.fork_rng(devices=[]):
            self._build(shape, dropout)
        _start(self, torch.Generator().manual_seed(seed))

    def _build(self, shape: Shape, dropout: float) -> None:
        half = shape.kernel // 2
        self.first = nn.Conv1d(1, shape.filters, shape.kernel, stride=shape.stride, padding=half)
        halvings = [Halving(shape.filters, shape.reduction) for _ in range(shape.blocks)]
        self.blocks = nn.Sequential(*halvings)
        self.dropout = nn.Dropout(dropout)
        flat = shape.steps[-1] * shape.filters
        self.hidden = nn.Linear(flat, shape.hidden) if shape.hidden else None
        self.head = nn.Linear(shape.hidden or flat, 1)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [batch] in metres."""
        maps = self.blocks(torch.relu(self.first(x.unsqueeze(1))))
        flat = self.dropout(maps.flatten(1))
        left = flat if self.hidden is None else torch.relu(self.hidden(flat))
        error: Tensor = self.head(left)
        return error.squeeze(-1)


def _start(module: nn.Module, generator: torch.Generator) -> None:
    for layer in module.modules():
        if isinstance(layer, nn.Conv1d | nn.Linear):
            nn.init.xavier_uniform_(layer.weight, generator=generator)
            assert layer.bias is not None
            nn.init.zeros_(layer.bias)
