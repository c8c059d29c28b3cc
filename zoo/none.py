"""The floor of every leaderboard: no mitigation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

import torch
from numpy.typing import ArrayLike
from torch import Tensor, nn

from zoo.base import Progress
from zoo.module_model import ModuleModel


class ZeroModule(nn.Module):
    """CIRs [n, width] -> zeros [n]."""

    def forward(self, x: Tensor) -> Tensor:
        """Return zeros [n]."""
        return torch.zeros_like(x[:, 0])


class NoMitigation(ModuleModel):
    """No mitigation: predicts an error of 0 m, so that the corrected range is the measured one.

    Takes rows of any width, whatever they hold.

    >>> import numpy as np
    >>> NoMitigation().fit(np.ones((3, 157)), [0.1, 0.2, 0.3]).predict(np.ones((2, 157))).tolist()
    [0.0, 0.0]
    """

    floor: ClassVar[bool] = True
    bits_depend_on_threads: ClassVar[bool] = False  # nothing is learnt
    does_without: ClassVar[tuple[str, ...]] = ("cir",)

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Check CIRs [n, width] and errors [n]; there is nothing to learn."""
        self._training_rows(X, y)
        self.module_ = ZeroModule()
        return self

    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        return ZeroModule()

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.regressor_tags.poor_score = True  # it does not look at the data
        return tags
