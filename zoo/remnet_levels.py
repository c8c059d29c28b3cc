"""REMnet with the receiver's levels and the range beside its CIR."""

from __future__ import annotations

from typing import Any, ClassVar

import torch
from torch import Tensor, nn

from zoo.base import TrainingRecipe
from zoo.block_model import NeuralBlockModel
from zoo.modules.blocks import Side
from zoo.modules.remnet import RemnetModule, reduced_length
from zoo.training.recipe import Stopping


class LevelsNetwork(nn.Module):
    """Scaled CIR bins and standardised side figures, side by side [n, bins + side] -> errors [n].

    REMnet's residual reductions on the bins; what they leave and the side figures, which pass
    `mixing` units of their own, meet in the head. A ReLU follows every layer but the last.
    """

    def __init__(
        self, bins: int, side: int, filters: int, reduction: int, mixing: int, dropout: float
    ) -> None:
        super().__init__()
        self.bins = bins
        trunk = RemnetModule(bins, filters, reduction=reduction)
        self.first, self.rrms = trunk.first, trunk.rrms
        left = reduced_length(bins, len(trunk.rrms)) * filters
        self.mix = nn.Linear(side, mixing)
        self.dropout = nn.Dropout(dropout)
        self.dense = nn.Linear(left + mixing, mixing)
        self.head = nn.Linear(mixing + mixing, 1)
        for layer in (self.mix, self.dense, self.head):
            nn.init.xavier_uniform_(layer.weight)
            nn.init.zeros_(layer.bias)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [n] in metres."""
        maps = self.rrms(torch.relu(self.first(x[:, : self.bins].unsqueeze(1)))).flatten(1)
        side = torch.relu(self.mix(x[:, self.bins :]))
        both = torch.cat([self.dropout(maps), side], 1)
        hidden = torch.relu(self.dense(both))
        error: Tensor = self.head(torch.cat([hidden, side], 1))
        return error.squeeze(-1)


class REMnetLevels(NeuralBlockModel):
    """REMnet's trunk on the CIR, with the receive levels and the range beside it.

    Source: the trunk is that of Angarano et al. 2021 (`zoo.remnet`) with 8 filters on the first
    64 bins; the side path is ours. Why: a CIR alone is scaled by the receiver's own gain, and the
    levels say how much of the power that should have come did. At most 6151 parameters, REMnet's
    own number. Trained by steps (MAE, Adam) until held-out links say stop.

    Unknown levels count as average ones. Needs a CIR and at least one known level.
    """

    reads: ClassVar[tuple[str, ...]] = ("cir", "levels", "range")
    does_without: ClassVar[tuple[str, ...]] = ("range",)

    def __init__(
        self,
        cir_samples: int = 64,
        filters: int = 8,
        reduction: int = 8,
        mixing: int = 24,
        dropout: float = 0.5,
        learning_rate: float = 1e-3,
        batch_size: int = 64,
        most_steps: int = 3000,
        weight_decay: float = 1e-4,
        random_state: int = 0,
    ) -> None:
        self.cir_samples = cir_samples
        self.filters = filters
        self.reduction = reduction
        self.mixing = mixing
        self.dropout = dropout
        self.learning_rate = learning_rate
        self.batch_size = batch_size
        self.most_steps = most_steps
        self.weight_decay = weight_decay
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return MAE, Adam, by steps."""
        return TrainingRecipe(
            "mae",
            self.learning_rate,
            self.batch_size,
            epochs=30,  # of quantisation-aware training, which holds nothing out
            weight_decay=self.weight_decay,
            stopping=Stopping(self.most_steps),
        )

    def _preparation(self, width: int) -> Side:
        return Side(self._layout(width), self.cir_samples)

    def _network(self, preparation: Any) -> nn.Module:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.random_state)
            sizes = (preparation.bins, preparation.side, self.filters, self.reduction)
            return LevelsNetwork(*sizes, self.mixing, self.dropout)
