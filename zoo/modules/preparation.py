"""What stands before a network inside the module: cropping, features, normalisation."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from zoo.base import Floats
from zoo.modules.scaling import Scaling

BLOCK_ROWS = 512  # bounds memory; twice as fast as 4096, whose maps leave the cache


class Crop(nn.Module):
    """The width rule of zoo.base: keep `samples` columns from column `first`.

    `samples` None keeps everything from `first` on. Raises ValueError, naming both widths, if
    rows of `width` are too narrow. Rows exactly as wide as wanted pass through untouched.

    >>> Crop(157, 5, 3)(torch.arange(157.0)[None]).tolist()
    [[5.0, 6.0, 7.0]]
    """

    def __init__(self, width: int, first: int, samples: int | None) -> None:
        super().__init__()
        self.first = first
        self.samples = max(width - first, 1) if samples is None else samples
        if first < 0 or self.samples < 1:
            raise ValueError(f"cannot crop {samples} samples from sample {first}")
        if width < first + self.samples:
            raise ValueError(
                f"CIRs are too narrow: {self.samples} samples from sample {first} on need rows "
                f"of at least {first + self.samples} samples, got {width}"
            )
        self.whole = width == self.samples

    def forward(self, x: Tensor) -> Tensor:
        """Return [n, samples] of CIRs [n, width]."""
        return x if self.whole else x[:, self.first : self.first + self.samples]


class Preparation(nn.Module):
    """Raw CIRs [n, width] -> what the network takes: crop, then `extract`, then `scaling`.

    `extract` (features, padding) has nothing to learn; `scaling` is fitted on training rows.
    """

    def __init__(self, crop: Crop, scaling: Scaling, extract: nn.Module | None = None) -> None:
        super().__init__()
        self.crop, self.scaling = crop, scaling
        self.extract = nn.Identity() if extract is None else extract

    def forward(self, x: Tensor) -> Tensor:
        """Return prepared rows."""
        prepared: Tensor = self.scaling(self.extract(self.crop(x)))
        return prepared

    def fit(self, cirs: Floats) -> Floats:
        """Fit the scaling on CIRs [n, width] and return the prepared rows."""
        values = apply_in_blocks(nn.Sequential(self.crop, self.extract), cirs)
        self.scaling.fit(values)
        return apply_in_blocks(self.scaling, values.numpy()).numpy()


def apply_in_blocks(module: nn.Module, rows: Floats) -> Tensor:
    """Return module(rows), without gradients and a block of rows at a time."""
    blocks = [rows[i : i + BLOCK_ROWS] for i in range(0, len(rows), BLOCK_ROWS)]
    with torch.inference_mode():
        # torch.tensor copies: rows may be read-only or mapped from a file
        done = [module(torch.tensor(block)) for block in blocks]
    return torch.cat(done)
