"""The convolutional network published with the 2023 positioning data set of Bregar."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from zoo.base import TrainingRecipe
from zoo.module_model import NeuralModel
from zoo.modules.folding import FoldedModel
from zoo.modules.preparation import Crop, Preparation
from zoo.modules.scaling import Standardise
from zoo.training.recipe import Stopping

SAMPLES = 152
FLAT = 80  # 20 maps of 4 after two convolutions of stride 2, two poolings, one more stride


class Bregar2023Network(nn.Module):
    """Standardised bins [n, 152] -> errors [n]; 13 927 trainable parameters.

    Five convolutions (2, 4, 4, 4, 4 taps; 10, 10, 10, 20, 20 maps; strides 1, 2, 2, 1, 2), each
    with batch normalisation and a leaky ReLU of 0.3; poolings by 2 after the third and the fifth;
    a dense layer of 128 with ReLU and dropout; one output. Weights start from a normal
    distribution of 0.1 cut at two deviations, biases at 0.1, from the global random state.
    """

    def __init__(self, dropout: float) -> None:
        super().__init__()
        self.convolutions = nn.Sequential(
            *_stage(1, 10, 2),
            *(nn.ConstantPad1d((1, 2), 0.0), *_stage(10, 10, 4, 2)),
            *(nn.ConstantPad1d((1, 1), 0.0), *_stage(10, 10, 4, 2), nn.MaxPool1d(2)),
            *_stage(10, 20, 4),
            *(nn.ConstantPad1d((1, 1), 0.0), *_stage(20, 20, 4, 2), nn.MaxPool1d(2)),
        )
        self.dense = nn.Linear(FLAT, 128)
        self.dropout = nn.Dropout(dropout)
        self.head = nn.Linear(128, 1)
        self.apply(_start)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [n] in metres."""
        maps = self.convolutions(x.unsqueeze(1))
        error: Tensor = self.head(self.dropout(torch.relu(self.dense(maps.flatten(1)))))
        return error.squeeze(-1)


def _stage(maps_in: int, maps: int, taps: int, stride: int = 1) -> tuple[nn.Module, ...]:
    """Return convolution, normalisation (momentum and epsilon as in Keras) and activation."""
    convolution = nn.Conv1d(maps_in, maps, taps, stride)
    return convolution, nn.BatchNorm1d(maps, eps=1e-3, momentum=0.01), nn.LeakyReLU(0.3)


def _start(layer: nn.Module) -> None:
    if isinstance(layer, nn.Conv1d | nn.Linear):
        nn.init.trunc_normal_(layer.weight, std=0.1, a=-0.2, b=0.2)
        nn.init.constant_(layer.bias, 0.1)  # type: ignore[arg-type]  # every layer here has one


class Bregar2023(FoldedModel, NeuralModel):
    """The CNN of the 2023 positioning data set, 13 927 parameters, on 152 bins.

    Source: K. Bregar, "Indoor UWB positioning and position tracking data set", Scientific Data
    10, 2023, and its repository KlemenBr/uwb_positioning (`train_ranging_error.py`, the model's
    JSON): Adam, mean squared error, dropout 0.5, the best of what held-out rows say. Different
    here: the code regresses |error|, this learns the signed error; it divides the CIR by its
    preamble count, here bins are standardised over the training rows; it takes batches of 8192 at
    1e-4 for up to 1000 epochs of data of hundreds of thousands of rows, here 256 at 1e-3 by steps
    suit a few thousand; it holds out rows, here whole links. Normalisation is folded into the
    convolutions when the model is exported.
    """

    def __init__(
        self,
        dropout: float = 0.5,
        learning_rate: float = 1e-3,
        batch_size: int = 256,
        most_steps: int = 2000,
        random_state: int = 0,
    ) -> None:
        self.dropout = dropout
        self.learning_rate = learning_rate
        self.batch_size = batch_size
        self.most_steps = most_steps
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return MSE, Adam, by steps."""
        stopping = Stopping(self.most_steps)
        return TrainingRecipe("mse", self.learning_rate, self.batch_size, 30, stopping=stopping)

    def _preparation(self, width: int) -> Preparation:
        return Preparation(Crop(width, 0, SAMPLES), Standardise(SAMPLES))

    def _network(self, preparation: Preparation) -> nn.Module:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.random_state)
            return Bregar2023Network(self.dropout)
