"""One REMnet in the hands of the fused kernels. Importing this module needs numba."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from zoo.modules.remnet import RemnetModule
from zoo.training.fused_remnet.entry import entry
from zoo.training.fused_remnet.layout import aligned_zeros, flatten, layout_of, unflatten
from zoo.training.fused_remnet.steps import Data, Network, Settings
from zoo.training.recipe import TrainingRecipe

DRAW_RANGE = 1 << 16


class FusedNetwork:
    """The weights of `module` and Adam's state, laid out for the kernels.

    The module itself stays as it was until `write_back`.
    """

    def __init__(self, module: RemnetModule, recipe: TrainingRecipe) -> None:
        self.module, self.layout, self.steps = module, layout_of(module), 0
        rate = module.dropout.p
        self.settings = Settings(
            recipe.batch_size,
            round(rate * DRAW_RANGE),
            np.float32(1.0 / (1.0 - rate)),
            recipe.learning_rate,
            recipe.weight_decay,
        )
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
            grads=aligned_zeros(size),
            part=aligned_zeros(size),
            work=aligned_zeros(layout.work),
        )

    def draws(self, rows: int, generator: np.random.Generator) -> NDArray[np.uint16]:
        """Return the uniform draws [rows, units] that decide which of the units drop out."""
        units = int(self.layout.net[0]["final"]) * 16
        return generator.integers(0, DRAW_RANGE, (rows, units), dtype=np.uint16)

    def learn(self, data: Data) -> float:
        """Step through `data`, C-contiguous; return its summed absolute error in metres."""
        total = entry()(self.network, data, self.settings, self.steps, True)
        self.steps += -(-len(data.errors) // self.settings.batch_size)
        return total

    def gradient(self, data: Data) -> NDArray[np.float32]:
        """Return the gradient of the last batch of `data`, in the layout's order."""
        entry()(self.network, data, self.settings, self.steps, False)
        gradient: NDArray[np.float32] = self.network.grads.copy()
        return gradient

    def write_back(self) -> None:
        """Put the weights into the module."""
        unflatten(self.network.parameters, self.module, self.layout)
