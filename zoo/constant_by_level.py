"""The floor of whoever reads the radio's registers: one number per stretch of receive level."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor, nn

from zoo.base import Floats, Progress
from zoo.block_model import BlockModel
from zoo.inputs import LEVELS, Input
from zoo.modules.blocks import BlockModule

LEVEL = LEVELS.index("rx_power_dbm")


class StepModule(BlockModule):
    """Levels [n, 8] -> start + the steps of every edge the receive power lies above: [n] metres.

    A row whose receive power is not known gets `unknown`.
    """

    edges: Tensor
    steps: Tensor
    start: Tensor
    unknown: Tensor

    def __init__(self, inputs: tuple[Input, ...], edges: int) -> None:
        super().__init__(inputs)
        for name, shape in (
            ("edges", (edges,)),
            ("steps", (edges,)),
            ("start", ()),
            ("unknown", ()),
        ):
            self.register_buffer(name, torch.zeros(shape))

    def compute(self, blocks: dict[str, Tensor]) -> Tensor:
        """Return the constants [n] in metres."""
        level = blocks["levels"][:, LEVEL : LEVEL + 1]
        climbed = torch.where(level > self.edges, self.steps, torch.zeros_like(self.steps))
        known = self.start + climbed.sum(1)
        return torch.where(torch.isnan(level[:, 0]), self.unknown, known)


class ConstantByLevel(BlockModel):
    """Predicts the median training error of the rows of like receive power.

    `pieces` (5) stretches of receive power (dBm) hold equally many training rows each. Five
    medians and four edges: the least a learnt model that reads levels has to beat. Needs
    `rx_power_dbm`; without it the pair is skipped.

    >>> X = np.zeros((4, 8), np.float32)
    >>> X[:, 0] = [-90, -90, -80, -80]
    >>> model = ConstantByLevel(pieces=2).fit(X, [0.4, 0.6, 0.1, 0.1])
    >>> model.predict(X[1:3]).round(2).tolist()
    [0.5, 0.10000000149011612]
    """

    floor: ClassVar[bool] = True
    bits_depend_on_threads: ClassVar[bool] = False
    reads: ClassVar[tuple[str, ...]] = ("levels",)
    needs_columns: ClassVar[tuple[str, ...]] = ("rx_power_dbm",)
    module_: StepModule

    def __init__(self, pieces: int = 5) -> None:
        self.pieces = pieces

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Fit on levels [n, 8], errors [n] in metres; ValueError if no receive power is known."""
        rows, errors = self._training_rows(X, y)
        level = rows[:, LEVEL].astype(np.float64)
        known = np.isfinite(level)
        if not known.any():
            raise ValueError(f"{LEVELS[LEVEL]} is known in no training row")
        edges, medians = _pieces(level[known], errors[known], self.pieces)
        module = StepModule(self._layout(rows.shape[1]), len(edges))
        module.edges.copy_(torch.tensor(edges))
        module.steps.copy_(torch.tensor(np.diff(medians)))
        module.start.fill_(float(medians[0]))
        module.unknown.fill_(float(np.median(errors)))
        self.module_ = module.eval()
        return self

    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        return StepModule(self._layout(width), len(weights["edges"]))

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.regressor_tags.poor_score = True  # a few constants
        return tags


def _pieces(level: NDArray[np.float64], errors: Floats, pieces: int) -> tuple[Floats, Floats]:
    """Return edges [k] and the median error of each piece [k + 1]; empty pieces are merged."""
    cuts = np.quantile(level, np.linspace(0, 1, pieces + 1)[1:-1])
    edges = np.unique(cuts[(cuts >= level.min()) & (cuts < level.max())])
    piece = np.searchsorted(edges, level)
    medians = [np.median(errors[piece == k]) for k in range(len(edges) + 1)]
    return edges.astype(np.float32), np.array(medians, np.float32)
