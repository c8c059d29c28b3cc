"""Perceptrons on halves of the links, blurred and averaged: the small network for few links."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

from torch import nn

from zoo.base import TrainingRecipe
from zoo.block_model import NeuralBlockModel
from zoo.modules.bagged import BaggedNetwork
from zoo.modules.blocks import Columns, Table
from zoo.training.bagged import Bagging, train_bagged
from zoo.training.recipe import TrainingLog


class BaggedMLP(NeuralBlockModel):
    """Eighteen perceptrons of 10 units on levels, range, features and the pulse, averaged.

    Source: bagging (Breiman, "Bagging predictors", 1996) by whole links, since rows of a link say
    the same; inputs blurred in training (Bishop, "Training with noise is equivalent to Tikhonov
    regularization", 1995) by 0.3, 0.6 and 1.2 standard deviations, six members each; shares of the
    three chosen on links that members have not seen (Breiman, "Stacked regressions", 1996), halfway
    to equal ones. Eight of the eighteen also see the pulse's shape (random subspaces, Ho 1998): 16
    samples from the one before the first path on, in dB below the peak. One graph of two dense
    layers: 6 121 parameters for 32 columns, many of them zeros.

    Why: from 20 links a network learns the links. What a figure says must hold when it is blurred,
    and what one half of the links says must suit the other half. Mean |residual|, AdamW at a
    falling rate. From 150 links on the average is trained further as one network where held-out
    links say so (`zoo.training.further`): there the blur costs more than it saves. Does without
    what a table lacks, as long as it has one of them.
    """

    reads: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    does_without: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")

    def __init__(
        self,
        hidden: int = 10,
        shape_samples: int = 16,
        per_noise: int = 6,
        noises: tuple[float, ...] = (0.3, 0.6, 1.2),
        steps: int = 1000,
        learning_rate: float = 3e-3,
        batch_size: int = 64,
        weight_decay: float = 1e-3,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.shape_samples = shape_samples
        self.per_noise = per_noise
        self.noises = noises
        self.steps = steps
        self.learning_rate = learning_rate
        self.batch_size = batch_size
        self.weight_decay = weight_decay
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return MAE, Adam; its epochs are those of training that goes on from the average."""
        return TrainingRecipe(
            "mae", self.learning_rate, self.batch_size, epochs=30, weight_decay=self.weight_decay
        )

    def _trainer(self) -> Callable[..., TrainingLog]:
        apart = self._columns(self.n_features_in_).shape.samples
        return partial(train_bagged, bagging=Bagging(tuple(self.noises), self.steps, apart))

    def _preparation(self, width: int) -> Table:
        return Table(self._columns(width))

    def _columns(self, width: int) -> Columns:
        return Columns(self._layout(width), shape_samples=self.shape_samples)

    def _network(self, preparation: Any) -> nn.Module:
        members = self.per_noise * len(self.noises)
        return BaggedNetwork(preparation.columns.width, members, self.hidden)
