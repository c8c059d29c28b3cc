"""A small residual network with efficient channel attention."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from zoo.base import TrainingRecipe
from zoo.module_model import NeuralModel
from zoo.modules.folding import FoldedModel
from zoo.modules.preparation import Crop, Preparation
from zoo.modules.scaling import GlobalScale
from zoo.training.recipe import Stopping

SAMPLES = 152


class ChannelAttention(nn.Module):
    """Gate each map by a 3-tap convolution over the maps' means: three parameters."""

    def __init__(self) -> None:
        super().__init__()
        self.convolution = nn.Conv1d(1, 1, 3, padding=1, bias=False)

    def forward(self, x: Tensor) -> Tensor:
        """Map [n, maps, time] to the same shape."""
        means = x.mean(2, keepdim=True).transpose(1, 2)
        return x * torch.sigmoid(self.convolution(means)).transpose(1, 2)


class AttentionBlock(nn.Module):
    """Two 3-tap convolutions with normalisation, attention, and a 1-tap way past them; stride 2."""

    def __init__(self, maps_in: int, maps: int) -> None:
        super().__init__()
        self.first = nn.Conv1d(maps_in, maps, 3, stride=2, padding=1, bias=False)
        self.first_normal = nn.BatchNorm1d(maps)
        self.second = nn.Conv1d(maps, maps, 3, padding=1, bias=False)
        self.second_normal = nn.BatchNorm1d(maps)
        self.attention = ChannelAttention()
        self.past = nn.Conv1d(maps_in, maps, 1, stride=2, bias=False)
        self.past_normal = nn.BatchNorm1d(maps)

    def forward(self, x: Tensor) -> Tensor:
        """Map [n, maps_in, time] to [n, maps, ceil(time / 2)]."""
        inner = torch.relu(self.first_normal(self.first(x)))
        inner = self.attention(self.second_normal(self.second(inner)))
        return torch.relu(inner + self.past_normal(self.past(x)))


class EcaNetwork(nn.Module):
    """Scaled bins [n, samples] -> errors [n]; 7 383 trainable parameters for 16 and 32 maps."""

    def __init__(self, maps: int) -> None:
        super().__init__()
        self.stem = nn.Conv1d(1, maps, 7, stride=2, padding=3, bias=False)
        self.stem_normal = nn.BatchNorm1d(maps)
        self.pool = nn.MaxPool1d(3, stride=2, padding=1)
        self.blocks = nn.Sequential(AttentionBlock(maps, maps), AttentionBlock(maps, 2 * maps))
        self.head = nn.Linear(2 * maps, 1)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [n] in metres."""
        maps = self.pool(torch.relu(self.stem_normal(self.stem(x.unsqueeze(1)))))
        error: Tensor = self.head(self.blocks(maps).mean(2))
        return error.squeeze(-1)


class ECANet(FoldedModel, NeuralModel):
    """ECA-ResNet of Niu et al. 2023, REDUCED: 16 and 32 maps, one block each, 7 383 parameters.

    Source: Niu et al. 2023 and the repository Joyar546/UWB-NLOS-Error-Mitigation-Greenhouse
    (`models/eca_resnetRE.py`): stem of 7 taps and stride 2, pooling, two stages of basic blocks
    with efficient channel attention. There the stages have 64 and 128 maps and as many blocks as
    asked for, and the last maps are averaged over 4 steps; here a quarter of the maps, one block
    a stage, and one mean over time, so that it suits a microcontroller. It must not be read as
    the published network's figure. Trained by steps (MAE, Adam) until held-out links say stop.
    """

    def __init__(
        self,
        maps: int = 16,
        learning_rate: float = 1e-3,
        batch_size: int = 128,
        most_steps: int = 2000,
        random_state: int = 0,
    ) -> None:
        self.maps = maps
        self.learning_rate = learning_rate
        self.batch_size = batch_size
        self.most_steps = most_steps
        self.random_state = random_state

    def training_recipe(self) -> TrainingRecipe:
        """Return MAE, Adam, by steps."""
        stopping = Stopping(self.most_steps)
        return TrainingRecipe("mae", self.learning_rate, self.batch_size, 30, stopping=stopping)

    def _preparation(self, width: int) -> Preparation:
        return Preparation(Crop(width, 0, SAMPLES), GlobalScale())

    def _network(self, preparation: Preparation) -> nn.Module:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.random_state)
            return EcaNetwork(self.maps)
