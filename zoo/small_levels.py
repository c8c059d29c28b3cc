"""A small convolutional network on the CIR beside perceptrons on the receiver's levels."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar, Self

from numpy.typing import ArrayLike
from torch import nn

from zoo.base import Progress, TrainingRecipe
from zoo.block_model import NeuralBlockModel
from zoo.modules.blended import BlendedNetwork
from zoo.modules.blocks import Side
from zoo.modules.small import Shape
from zoo.remnet import REMnet
from zoo.training.bagged import Bagging
from zoo.training.blended import train_blended
from zoo.training.recipe import TrainingLog
from zoo.training.teacher import half, word_of


class SmallLevels(NeuralBlockModel):
    """A network like `SmallCNN` and perceptrons like `BaggedMLP`'s, both small, in one graph.

    Source: the search of docs/search.md for the first, with one more block that halves; six
    perceptrons of 3 units on levels, range and eight samples of the pulse in dB for the second.
    Each one's share of the answer is found on links that it was not trained on (Breiman, "Stacked
    regressions", 1996): on twenty links a convolutional network learns the links, on a thousand it
    learns pulses. `distilled` as in `SmallCNN`. At most a quarter of REMnet's cycles on a
    microcontroller and half of its flash.

    Unknown levels count as average ones. Needs a CIR and at least one known level.
    """

    reads: ClassVar[tuple[str, ...]] = ("cir", "levels", "range")
    does_without: ClassVar[tuple[str, ...]] = ("range",)

    def __init__(
        self,
        samples: int = 96,
        filters: int = 16,
        blocks: int = 2,
        shape_samples: int = 8,
        hidden: int = 3,
        per_noise: int = 2,
        noises: tuple[float, ...] = (0.3, 0.6, 1.2),
        steps: int = 1000,
        distilled: bool = True,
        learning_rate: float = 3e-3,
        epochs: int = 20,
        batch_size: int = 64,
        random_state: int = 0,
    ) -> None:
        self.samples = samples
        self.filters = filters
        self.blocks = blocks
        self.shape_samples = shape_samples
        self.hidden = hidden
        self.per_noise = per_noise
        self.noises = noises
        self.steps = steps
        self.distilled = distilled
        self.learning_rate = learning_rate
        self.epochs = epochs
        self.batch_size = batch_size
        self.random_state = random_state

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
        said_m: ArrayLike | None = None,
    ) -> Self:
        """Train on rows [n, width] and errors [n] in metres; the teacher first, if there is one.

        `said_m` [n]: what `teacher()`, fitted on the CIRs of these rows, says of them, where that
        is known. Raises ValueError for rows that are too narrow, a CIR with NaN, or that do not
        match `y`.
        """
        if said_m is None and (teacher := self.teacher()) is not None:
            rows, errors_m = self._training_rows(X, y)
            cirs = rows[:, : self._layout(rows.shape[1])[0].width]
            said_m = word_of(teacher, cirs, errors_m, half(progress, 0.0))
            progress = half(progress, 0.5)
        self._said_m = said_m
        try:
            return super().fit(X, y, progress=progress, groups=groups)
        finally:
            del self._said_m

    def teacher(self) -> REMnet | None:
        """Return the REMnet that teaches the network on the CIR, None unless it is `distilled`."""
        return REMnet(random_state=self.random_state) if self.distilled else None

    def training_recipe(self) -> TrainingRecipe:
        """Return MAE, Adam at a falling rate."""
        return TrainingRecipe("mae", self.learning_rate, self.batch_size, self.epochs, decay=True)

    def _trainer(self) -> Callable[..., TrainingLog]:
        bagging = Bagging(tuple(self.noises), self.steps)
        return partial(train_blended, bagging=bagging, said_m=getattr(self, "_said_m", None))

    def _preparation(self, width: int) -> Side:
        return Side(self._layout(width), self.samples, self.shape_samples)

    def _network(self, preparation: Any) -> nn.Module:
        shape = Shape(self.samples, self.filters, 7, 2, self.blocks)
        members = self.per_noise * len(self.noises)
        return BlendedNetwork(shape, preparation.side, members, self.hidden, self.random_state)
