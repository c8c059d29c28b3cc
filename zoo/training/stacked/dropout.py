"""Dropout for stacked networks: each network's masks as it would have drawn them alone."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import NamedTuple

import torch
from torch import Tensor, nn


class GivenMask(nn.Module):
    """Stands where a Dropout stood; multiplies by the buffer `mask`, set from outside."""

    def __init__(self, rate: float) -> None:
        super().__init__()
        self.rate = rate
        self.register_buffer("mask", torch.ones(()))

    def forward(self, x: Tensor) -> Tensor:
        """Mask x [batch, ...]."""
        return x * self.get_buffer("mask")


class Place(NamedTuple):
    """A dropout in a network: the name of its buffer, its rate and the shape of one row there."""

    name: str
    rate: float
    shape: tuple[int, ...]


def expose_dropout(module: nn.Module, row: Tensor) -> tuple[nn.Module, list[Place]]:
    """Return a copy of `module` with GivenMask for Dropout, and the places in calling order.

    `row` is a batch of one. Raises ValueError if a dropout is called more than once.
    """
    template = copy.deepcopy(module).train()
    for name, child in module.named_modules():
        if isinstance(child, nn.Dropout) and child.p > 0:  # a rate of 0 draws nothing
            template.set_submodule(name, GivenMask(child.p))
    places: list[Place] = []
    handles = [
        child.register_forward_pre_hook(_recorder(name, child.rate, places))
        for name, child in template.named_modules()
        if isinstance(child, GivenMask)
    ]
    with torch.no_grad():
        template(row)
    for handle in handles:
        handle.remove()
    if len({place.name for place in places}) < len(places):
        raise ValueError("a dropout is called twice in one pass")
    return template, places


def _recorder(
    name: str, rate: float, places: list[Place]
) -> Callable[[nn.Module, tuple[Tensor]], None]:
    def record(_: nn.Module, arguments: tuple[Tensor]) -> None:
        places.append(Place(f"{name}.mask", rate, tuple(arguments[0].shape[1:])))

    return record


class MaskSource:
    """The masks of all networks, network m drawing from its own seeds[m]."""

    def __init__(self, places: Sequence[Place], seeds: Sequence[int], batch_size: int) -> None:
        self._places = places
        self._generators = [torch.Generator().manual_seed(seed) for seed in seeds]
        self._kept = {
            place.name: torch.zeros(len(seeds), batch_size, *place.shape) for place in places
        }

    def draw(self, counts: Sequence[int]) -> dict[str, Tensor]:
        """Return the masks [networks, batch, ...] by name, for counts[m] rows of network m.

        Each is the draw torch's own dropout makes, so the same stream gives the same mask.
        """
        for network, (count, generator) in enumerate(zip(counts, self._generators, strict=True)):
            for place in self._places:
                if count:
                    kept = self._kept[place.name][network, :count]
                    kept.bernoulli_(1.0 - place.rate, generator=generator)
        return {
            place.name: self._kept[place.name] * (1.0 / (1.0 - place.rate))
            for place in self._places
        }
