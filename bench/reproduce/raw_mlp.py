"""The perceptron on the raw CIR, with which the paper looks at its data before it has a model."""

from __future__ import annotations

import torch
from torch import nn

from zoo.base import TrainingRecipe
from zoo.mlp import MlpNetwork
from zoo.module_model import NeuralModel
from zoo.modules.preparation import Crop, Preparation
from zoo.modules.scaling import Standardise


class RawMLP(NeuralModel):
    """MLP of 3 layers with 64 hidden neurons on standardised CIR magnitudes.

    The paper says no more of it than "trained directly on the CIR waveform"; layers, loss (MAE),
    rate (1e-3), batch and epochs are those of its other perceptron here.
    """

    def __init__(
        self,
        hidden: int = 64,
        learning_rate: float = 1e-3,
        epochs: int = 30,
        batch_size: int = 32,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.learning_rate = learning_rate
        self.epochs = epochs
        self.batch_size = batch_size
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return the protocol: MAE, Adam."""
        return TrainingRecipe("mae", self.learning_rate, self.batch_size, self.epochs)

    def _preparation(self, width: int) -> Preparation:
        crop = Crop(width, 0, None)
        return Preparation(crop, Standardise(crop.samples))

    def _network(self, preparation: Preparation) -> nn.Module:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.random_state)
            return MlpNetwork(preparation.crop.samples, self.hidden)
