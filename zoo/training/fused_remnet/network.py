"""One REMnet in the hands of the fused kernels. Importing this module needs numba."""

from __future__ import annotations

from concurrent.futures import Executor

import numpy as np
from numpy.typing import NDArray

from zoo.modules.remnet import RemnetModule
from zoo.training.fused_remnet.entry import entry
from zoo.training.fused_remnet.layout import aligned_zeros, flatten, layout_of, unflatten
from zoo.training.fused_remnet.steps import GRADIENT, HELP, LEAD, SLOTS, Data, Network, Recipe
from zoo.training.fused_remnet.team import CLOSED, COUNTERS

DRAW_RANGE = 1 << 16


class FusedNetwork:
    """The weights of `module` and Adam's state, laid out for the kernels.

    The module itself stays as it was until `write_back`.
    """

    def __init__(
        self,
        module: RemnetModule,
        *,
        learning_rate: float = 3e-4,
        batch_size: int = 32,
        weight_decay: float = 0.0,
    ) -> None:
        self.module, self.layout, self.steps = module, layout_of(module), 0
        rate = module.dropout.p
        keep = np.float32(1.0 / (1.0 - rate))
        drop_below = round(rate * DRAW_RANGE)
        self.recipe = Recipe(batch_size, drop_below, keep, learning_rate, weight_decay)
        self.network = self._arrays()

    def _arrays(self) -> Network:
        size, layout = self.layout.parameters, self.layout
        return Network(
            net=layout.net,
            blocks=layout.blocks,
            parameters=flatten(self.module, layout),
            mean=aligned_zeros(size),
            square=aligned_zeros(size),
            back=aligned_zeros(layout.transposed),
            grads=aligned_zeros(SLOTS, size),
            work=aligned_zeros(SLOTS, layout.work),
            losses=np.zeros(SLOTS),
            counters=np.zeros(COUNTERS, np.int64),
        )

    def draws(self, rows: int, generator: np.random.Generator) -> NDArray[np.uint16]:
        """Return the uniform draws [rows, units] that decide which of the units drop out."""
        units = int(self.layout.net[0]["final"]) * 16
        return generator.integers(0, DRAW_RANGE, (rows, units), dtype=np.uint16)

    def learn(self, data: Data, pool: Executor, helpers: int) -> float:
        """Step through `data`, C-contiguous; return its summed absolute error in metres."""
        self.network.counters[:] = 0
        jobs = [
            pool.submit(entry(), self.network, data, self.recipe, self.steps, HELP)
            for _ in range(helpers)
        ]
        try:
            total = entry()(self.network, data, self.recipe, self.steps, LEAD)
        finally:
            self.network.counters[CLOSED] = 1  # or the helpers of an interrupted call never end
        for job in jobs:
            job.result()
        self.steps += -(-len(data.errors) // self.recipe.batch_size)
        return total

    def gradient(self, data: Data) -> NDArray[np.float32]:
        """Return the gradient of the last batch of `data`, in the layout's order."""
        self.network.counters[:] = 0
        entry()(self.network, data, self.recipe, self.steps, GRADIENT)
        gradient: NDArray[np.float32] = self.network.grads[0].copy()
        return gradient

    def write_back(self) -> None:
        """Put the weights into the module."""
        unflatten(self.network.parameters, self.module, self.layout)
