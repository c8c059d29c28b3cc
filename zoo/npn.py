"""A natural-parameter network: mean and variance of the error through every layer."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import torch
from torch import Tensor, nn

from zoo.base import TrainingRecipe
from zoo.block_model import NeuralBlockModel
from zoo.modules.blocks import Columns, Table
from zoo.training.recipe import Stopping

_SLOPE = math.sqrt(8 / math.pi)  # of the logistic function that stands for the normal one
_LEAST = 1e-8  # metres squared, or a unit's square: keeps roots and divisions finite


class NaturalLinear(nn.Module):
    """A dense layer whose weights are normal distributions: mean and variance in and out."""

    def __init__(self, units_in: int, units: int) -> None:
        super().__init__()
        self.mean = nn.Linear(units_in, units)
        nn.init.xavier_uniform_(self.mean.weight)
        nn.init.zeros_(self.mean.bias)
        # softplus of these are the variances
        self.spread = nn.Parameter(torch.full((units, units_in), -6.0))
        self.bias_spread = nn.Parameter(torch.full((units,), -6.0))

    def forward(self, mean: Tensor, variance: Tensor | None) -> tuple[Tensor, Tensor]:
        """Return mean and variance [n, units] of the sums."""
        weight_variance = nn.functional.softplus(self.spread)
        bias_variance = nn.functional.softplus(self.bias_spread)
        out = nn.functional.linear(mean * mean, weight_variance, bias_variance)
        if variance is not None:
            squared = self.mean.weight * self.mean.weight
            out = out + nn.functional.linear(variance, weight_variance + squared)
        return self.mean(mean), out


def natural_relu(mean: Tensor, variance: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and variance of max(x, 0) for normal x, the normal integral as a logistic."""
    root = torch.sqrt(variance + _LEAST)
    above = torch.sigmoid(_SLOPE * mean / root)
    density = root * torch.exp(-mean * mean / (2 * (variance + _LEAST))) / math.sqrt(2 * math.pi)
    first = above * mean + density
    second = above * (mean * mean + variance) + mean * density
    return first, torch.relu(second - first * first) + _LEAST


class NaturalNetwork(nn.Module):
    """Figures [n, columns] -> [n, 2]: mean error (m) and the logarithm of its deviation."""

    def __init__(self, columns: int, hidden: int) -> None:
        super().__init__()
        self.first = NaturalLinear(columns, hidden)
        self.second = NaturalLinear(hidden, hidden)
        self.head = NaturalLinear(hidden, 1)

    def forward(self, x: Tensor) -> Tensor:
        """Return mean and log standard deviation [n, 2]."""
        mean, variance = natural_relu(*self.first(x, None))
        mean, variance = natural_relu(*self.second(mean, variance))
        mean, variance = self.head(mean, variance)
        return torch.cat([mean, 0.5 * torch.log(variance + _LEAST)], 1)


def normal_loss(predicted: Tensor | tuple[Tensor, Tensor], errors: Tensor) -> Tensor:
    """Return the mean negative log likelihood of normal errors [n].

    `predicted` is mean and log deviation [n, 2], or the exported pair of mean and deviation.
    """
    if isinstance(predicted, tuple):
        mean, log_std = predicted[0], torch.log(predicted[1])
    else:
        mean, log_std = predicted[..., 0], predicted[..., 1]
    log_std = torch.clamp_min(log_std, math.log(0.01))  # a link's repeats would make it 0
    return (log_std + 0.5 * ((errors - mean) / torch.exp(log_std)).square()).mean()


class NPN(NeuralBlockModel):
    """Natural-parameter network on levels, range and the six features; gives a deviation.

    Source: C. Mao, K. Lin, T. Yu, Y. Shen, "A probabilistic learning approach to UWB ranging error
    mitigation", GLOBECOM 2018 (repository ChengzhiCU/UWB_ML, `learning/npn.py`), with the layers
    of Wang, Shi and Yeung, NIPS 2016: every weight is a normal distribution, and means and
    variances pass the layers in closed form. Two hidden layers of 32 units; each weight and bias
    counts twice: 3 266 parameters for 16 columns. Normal likelihood, Adam, by steps until
    held-out links say stop. Does without what a table lacks, as long as it has one of them.
    """

    reads: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    does_without: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    gives_std: ClassVar[bool] = True

    def __init__(
        self,
        hidden: int = 32,
        learning_rate: float = 1e-3,
        batch_size: int = 128,
        most_steps: int = 3000,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.learning_rate = learning_rate
        self.batch_size = batch_size
        self.most_steps = most_steps
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return the likelihood, Adam, by steps."""
        stopping = Stopping(self.most_steps)
        return TrainingRecipe(
            normal_loss, self.learning_rate, self.batch_size, 30, stopping=stopping
        )

    def _preparation(self, width: int) -> Table:
        return Table(Columns(self._layout(width)))

    def _network(self, preparation: Any) -> nn.Module:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.random_state)
            return NaturalNetwork(preparation.columns.width, self.hidden)
