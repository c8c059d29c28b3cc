"""The mean of a network's weights over the last steps: what a constant rate circles around."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import torch
from torch import Tensor, nn


class RunningMean:
    """A module's weights, averaged over its steps with a memory of some `memory` of them.

    Source: Polyak and Juditsky, "Acceleration of stochastic approximation by averaging", 1992. At
    first the memory is a tenth of the steps taken, so that where training began is soon forgotten.
    Whole numbers of the state, such as counts of batches, are left as they are.
    """

    def __init__(self, module: nn.Module, memory: int = 1000) -> None:
        self._now = [v for v in module.state_dict().values() if v.is_floating_point()]
        self._mean = [value.clone() for value in self._now]
        self._memory, self._steps = memory, 0

    def take(self) -> None:
        """Take the weights after one more step into the mean."""
        self._steps += 1
        share = max(1 / self._memory, 9 / (self._steps + 9))
        with torch.no_grad():
            for mean, now in zip(self._mean, self._now, strict=True):
                mean.lerp_(now, share)

    @contextmanager
    def worn(self) -> Iterator[None]:
        """Have the module wear the mean meanwhile."""
        own = [value.clone() for value in self._now]
        self._put(self._mean)
        try:
            yield
        finally:
            self._put(own)

    def _put(self, values: list[Tensor]) -> None:
        with torch.no_grad():
            for now, value in zip(self._now, values, strict=True):
                now.copy_(value)
