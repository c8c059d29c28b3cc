"""The floor above no mitigation: one number for every range."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import Tensor, nn

from zoo.base import Progress
from zoo.block_model import BlockModel
from zoo.inputs import Input
from zoo.modules.blocks import BlockModule


class ConstantModule(BlockModule):
    """Rows [n, width] -> one constant [n], in metres."""

    value: Tensor

    def __init__(self, inputs: tuple[Input, ...]) -> None:
        super().__init__(inputs)
        self.register_buffer("value", torch.zeros(()))

    def compute(self, blocks: dict[str, Tensor]) -> Tensor:
        """Return the constant [n]."""
        rows = next(iter(blocks.values()))
        return torch.zeros_like(rows[:, 0]) + self.value


class Constant(BlockModel):
    """Predicts the median of the training errors: an antenna delay set right, nothing more.

    A model that does not beat it has learnt an offset. No parameters beyond that one number. It
    reads nothing; its rows are the range only because a graph needs an input to count rows by.

    >>> Constant().fit([[1.0], [2.0], [3.0]], [0.1, 0.2, 0.9]).predict([[5.0]]).round(2).tolist()
    [0.20000000298023224]
    """

    floor: ClassVar[bool] = True
    bits_depend_on_threads: ClassVar[bool] = False
    reads: ClassVar[tuple[str, ...]] = ("range",)
    does_without: ClassVar[tuple[str, ...]] = ("range",)
    module_: ConstantModule

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Take the median of errors [n] in metres; rows [n, 1] are only counted."""
        rows, errors = self._training_rows(X, y)
        self.module_ = ConstantModule(self._layout(rows.shape[1])).eval()
        self.module_.value.fill_(float(np.median(errors)))
        return self

    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        return ConstantModule(self._layout(width))

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.regressor_tags.poor_score = True  # it does not look at the data
        return tags
