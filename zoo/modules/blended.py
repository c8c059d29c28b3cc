"""A small convolutional network and perceptrons on a few figures, one answer from both."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from zoo.modules.bagged import BaggedNetwork
from zoo.modules.small import Shape, SmallNetwork


class BlendedNetwork(nn.Module):
    """Scaled CIR bins and standardised figures [n, bins + side] -> errors [n] in metres.

    A `SmallNetwork` on the bins plus a `BaggedNetwork` on the figures; the last weights of each
    hold its share of the answer once `blend` has been called.
    """

    def __init__(self, shape: Shape, side: int, members: int, hidden: int, seed: int) -> None:
        super().__init__()
        self.bins = shape.samples
        self.trunk = SmallNetwork(shape, seed=seed)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.perceptrons = BaggedNetwork(side, members, hidden)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [n] in metres."""
        errors: Tensor = self.trunk(x[:, : self.bins]) + self.perceptrons(x[:, self.bins :])
        return errors

    def blend(self, share: float) -> None:
        """Give the convolutional network `share` of the answer and the perceptrons the rest."""
        parts = ((self.trunk.head, share), (self.perceptrons.head, 1.0 - share))
        with torch.no_grad():
            for layer, part in parts:
                layer.weight.mul_(part)
                layer.bias.mul_(part)
