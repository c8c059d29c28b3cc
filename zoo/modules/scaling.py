"""Normalisation that lives inside a model's module, fitted on its training rows."""

from __future__ import annotations

import torch
from torch import Tensor, nn

_TINY = 1e-20


class Scaling(nn.Module):
    """Base of the scalings: [n, columns] -> [n, columns], plus a `fit` on training rows."""

    def fit(self, values: Tensor) -> None:
        """Take what is needed from training rows [n, columns]; nothing by default."""


class Standardise(Scaling):
    """Subtract each column's mean and divide by its standard deviation over the training rows.

    A column that never changes is only centred.

    >>> scaling = Standardise(2)
    >>> scaling.fit(torch.tensor([[1.0, 5.0], [3.0, 5.0]]))
    >>> scaling(torch.tensor([[5.0, 5.0]])).tolist()
    [[3.0, 0.0]]
    """

    mean: Tensor
    std: Tensor

    def __init__(self, columns: int) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(columns))
        self.register_buffer("std", torch.ones(columns))

    def fit(self, values: Tensor) -> None:
        """Take mean and standard deviation of training rows [n, columns]."""
        std, mean = torch.std_mean(values.double(), 0, correction=0)
        constant = std <= 1e-7 * mean.abs()  # below what float32 rows can hold
        self.mean.copy_(mean)
        self.std.copy_(torch.where(constant, 1.0, std))

    def forward(self, x: Tensor) -> Tensor:
        """Return standardised rows."""
        return (x - self.mean) / self.std


class GlobalScale(Scaling):
    """Divide everything by one number: the mean over the training rows of each row's maximum.

    Absolute level, which tells near from far and clear from blocked, survives.

    >>> scaling = GlobalScale()
    >>> scaling.fit(torch.tensor([[1.0, 2.0], [6.0, 0.0]]))
    >>> scaling(torch.tensor([[2.0, 8.0]])).tolist()
    [[0.5, 2.0]]
    """

    scale: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("scale", torch.ones(()))

    def fit(self, values: Tensor) -> None:
        """Take the mean maximum of training rows [n, columns]."""
        scale = values.abs().amax(1).double().mean()
        self.scale.copy_(torch.where(scale > 0, scale, 1.0))

    def forward(self, x: Tensor) -> Tensor:
        """Return scaled rows."""
        return x / self.scale


class PeakScale(Scaling):
    """Divide each row by its own maximum: the level is lost, the shape alone is left.

    >>> PeakScale()(torch.tensor([[1.0, 2.0], [0.0, 0.0]])).tolist()
    [[0.5, 1.0], [0.0, 0.0]]
    """

    def forward(self, x: Tensor) -> Tensor:
        """Return rows with a maximum magnitude of 1; all-zero rows stay zero."""
        return x / x.abs().amax(1, keepdim=True).clamp_min(_TINY)
