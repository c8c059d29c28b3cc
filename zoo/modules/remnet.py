"""REMnet as a torch module.

Source: Angarano, Mazzia, Salvetti, Fantin, Chiaberge, "Robust Ultra-wideband Range Error
Mitigation with Deep Learning at the Edge", 2021, section "Network Design".
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

FIRST_KERNEL = 7  # with 3 and 1 below, the only sizes that give the paper's 6151 parameters
CONV_KERNEL = 3


class SqueezeExcitation(nn.Module):
    """Scale each feature by a gate in (0, 1) computed from its mean over time."""

    def __init__(self, features: int, reduction: int) -> None:
        super().__init__()
        self.squeeze = nn.Linear(features, features // reduction)
        self.excite = nn.Linear(features // reduction, features)

    def forward(self, x: Tensor) -> Tensor:
        """Map [batch, features, time] to the same shape."""
        hidden = torch.relu(self.squeeze(x.mean(dim=-1)))
        gate: Tensor = torch.sigmoid(self.excite(hidden))
        return x * gate.unsqueeze(-1)


class ResidualReduction(nn.Module):
    """One RRM: a gated residual convolution, then two stride-2 convolutions summed."""

    def __init__(self, features: int, reduction: int) -> None:
        super().__init__()
        same = CONV_KERNEL // 2
        self.residual = nn.Conv1d(features, features, CONV_KERNEL, padding=same)
        self.gate = SqueezeExcitation(features, reduction)
        self.wide = nn.Conv1d(features, features, CONV_KERNEL, stride=2, padding=same)
        self.narrow = nn.Conv1d(features, features, 1, stride=2)

    def forward(self, x: Tensor) -> Tensor:
        """Map [batch, features, time] to [batch, features, ceil(time / 2)]."""
        x = self.gate(torch.relu(self.residual(x))) + x
        return torch.relu(self.wide(x)) + torch.relu(self.narrow(x))


class RemnetModule(nn.Module):
    """REMnet: scaled CIR magnitudes [batch, samples] to range errors [batch] in metres.

    Weights start Glorot uniform with zero biases, drawn from `seed` alone; the global random
    state is left as it was. The defaults have exactly 6151 trainable parameters.

    Raises ValueError if a size is not positive, `reduction` does not divide `features`, or
    `dropout` lies outside [0, 1).
    """

    def __init__(
        self,
        samples: int = 128,
        features: int = 16,
        modules: int = 3,
        reduction: int = 8,
        *,
        dropout: float = 0.5,
        seed: int = 0,
    ) -> None:
        super().__init__()
        _check_sizes(samples, features, modules, reduction, dropout)
        self.samples, self.features, self.reduction = samples, features, reduction
        with torch.random.fork_rng(devices=[]):
            self._build(modules, dropout)
        _start_glorot(self, torch.Generator().manual_seed(seed))

    def _build(self, modules: int, dropout: float) -> None:
        self.first = nn.Conv1d(1, self.features, FIRST_KERNEL, padding=FIRST_KERNEL // 2)
        self.rrms = nn.Sequential(
            *(ResidualReduction(self.features, self.reduction) for _ in range(modules))
        )
        self.dropout = nn.Dropout(dropout)
        time = reduced_length(self.samples, modules)
        self.head = nn.Linear(time * self.features, 1)

    def forward(self, x: Tensor) -> Tensor:
        """Map scaled CIRs [batch, samples] to errors [batch] in metres."""
        maps = self.rrms(torch.relu(self.first(x.unsqueeze(1))))
        error: Tensor = self.head(self.dropout(maps.flatten(1)))
        return error.squeeze(-1)


def reduced_length(samples: int, modules: int) -> int:
    """Return the time steps left of `samples` after `modules` stride-2 reductions."""
    for _ in range(modules):
        samples = (samples + 1) // 2
    return samples


def _check_sizes(samples: int, features: int, modules: int, reduction: int, dropout: float) -> None:
    if min(samples, features, reduction) < 1 or modules < 0:
        raise ValueError("samples, features and reduction must be positive, modules not negative")
    if features % reduction:
        raise ValueError(f"reduction {reduction} does not divide features {features}")
    if not 0.0 <= dropout < 1.0:
        raise ValueError(f"dropout must be in [0, 1), got {dropout}")


def _start_glorot(module: nn.Module, generator: torch.Generator) -> None:
    for layer in module.modules():
        if isinstance(layer, nn.Conv1d | nn.Linear):
            nn.init.xavier_uniform_(layer.weight, generator=generator)
            assert layer.bias is not None
            nn.init.zeros_(layer.bias)
