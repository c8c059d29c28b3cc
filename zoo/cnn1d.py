"""The convolutional network of Bregar and Mohorcic."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from zoo.base import TrainingRecipe
from zoo.module_model import NeuralModel
from zoo.modules.preparation import Crop, Preparation
from zoo.modules.scaling import Standardise
from zoo.training.recipe import Stopping

FEWEST_SAMPLES = 30  # with fewer, nothing is left after the second pooling


class BregarNetwork(nn.Module):
    """Standardised bins [n, samples] -> errors [n]; 47 147 parameters for 152 bins.

    Every convolution starts Glorot uniform with zero biases, as in Keras, from the global
    random state.
    """

    def __init__(self, samples: int, dropout: float) -> None:
        super().__init__()
        self.convolutions = nn.Sequential(
            *(nn.Conv1d(1, 10, 4), nn.ReLU()),
            *(nn.Conv1d(10, 20, 5, stride=2, padding=2), nn.ReLU(), nn.MaxPool1d(2)),
            *(nn.Conv1d(20, 20, 4), nn.ReLU()),
            *(nn.Conv1d(20, 40, 4, stride=2, padding=1), nn.ReLU(), nn.MaxPool1d(2)),
        )
        self.dense = nn.Linear(flat_features(samples), 128)
        self.dropout = nn.Dropout(dropout)
        self.head = nn.Linear(128, 1)
        self.apply(_start_glorot)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [n] in metres."""
        maps = self.convolutions(x.unsqueeze(1))
        hidden = torch.relu(self.dense(maps.flatten(1)))
        error: Tensor = self.head(self.dropout(hidden))
        return error.squeeze(-1)


def flat_features(samples: int) -> int:
    """Return the length of the flattened maps: 320 for 152 samples."""
    first = ((samples - 3 + 1) // 2) // 2  # conv 4 valid, conv 5 stride 2 same, pool 2
    second = ((first - 3) // 2) // 2  # conv 4 valid, conv 4 stride 2 padded 1, pool 2
    return 40 * second


def _start_glorot(layer: nn.Module) -> None:
    if isinstance(layer, nn.Conv1d | nn.Linear):
        nn.init.xavier_uniform_(layer.weight)
        nn.init.zeros_(layer.bias)  # type: ignore[arg-type]  # every layer here has one


class CNN1D(NeuralModel):
    """The CNN of Bregar and Mohorcic on 152 bins from the detected first path on.

    Source: K. Bregar, M. Mohorcic, "Improving Indoor Localization Using Convolutional Neural
    Networks on Computationally Restricted Devices", IEEE Access 2018, and the authors' published
    code: Adam at 1e-4, MSE, batches of 200, dropout 0.5. Three things differ on purpose. The code
    regresses |error|; this learns the signed error, which is what a range is corrected by. The
    code divides the CIR by its preamble count, which a model that sees only the CIR does not
    have; bins are standardised over the training rows, as in the code, without it. And it is
    trained by steps, at 5e-4, until held-out links say stop: on the simulated `rooms` less error
    than 7200 steps at the authors' rate, in a third of the steps. Theirs is `epochs=40,
    learning_rate=1e-4`: with `epochs` (not None) there are so many passes and nothing is held out.

    `cir_samples` bins are used from `first_sample` on, by default the detected first path; None
    takes all that follow, padded with zeros on the right to the 30 that the layers need.

    >>> import numpy as np
    >>> rng = np.random.default_rng(0)
    >>> X, y = rng.rayleigh(100, (40, 40)), rng.normal(0.1, 0.1, 40)
    >>> model = CNN1D(cir_samples=32, epochs=1).fit(X, y)
    >>> model.predict(X[:3]).shape
    (3,)
    """

    def __init__(
        self,
        cir_samples: int | None = 152,
        first_sample: int = 5,
        dropout: float = 0.5,
        learning_rate: float = 5e-4,
        epochs: int | None = None,
        batch_size: int = 200,
        most_steps: int = 2400,
        random_state: int = 0,
    ) -> None:
        self.cir_samples = cir_samples
        self.first_sample = first_sample
        self.dropout = dropout
        self.learning_rate = learning_rate
        self.epochs = epochs
        self.batch_size = batch_size
        self.most_steps = most_steps
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return MSE, Adam, by steps or, where they are said, by epochs."""
        by_steps = self.epochs is None
        stopping = Stopping(self.most_steps, 200, 3) if by_steps else None
        epochs = 40 if self.epochs is None else self.epochs
        return TrainingRecipe("mse", self.learning_rate, self.batch_size, epochs, stopping=stopping)

    def _preparation(self, width: int) -> Preparation:
        crop = Crop(width, self.first_sample, self.cir_samples)
        missing = FEWEST_SAMPLES - crop.samples
        if missing <= 0:
            return Preparation(crop, Standardise(crop.samples))
        if self.cir_samples is not None:
            raise ValueError(f"cir_samples must be at least {FEWEST_SAMPLES}, got {crop.samples}")
        return Preparation(crop, Standardise(FEWEST_SAMPLES), nn.ConstantPad1d((0, missing), 0.0))

    def _network(self, preparation: Preparation) -> nn.Module:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.random_state)
            return BregarNetwork(max(preparation.crop.samples, FEWEST_SAMPLES), self.dropout)
