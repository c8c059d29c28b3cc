"""A small convolutional network, taught by REMnet."""

from __future__ import annotations

from collections.abc import Callable
from typing import Self

from numpy.typing import ArrayLike
from torch import nn

from zoo.base import Progress, TrainingRecipe
from zoo.module_model import NeuralModel
from zoo.modules.preparation import Crop, Preparation
from zoo.modules.scaling import GlobalScale
from zoo.modules.small import Shape, SmallNetwork
from zoo.remnet import REMnet
from zoo.training import by_hand
from zoo.training.recipe import TrainingLog
from zoo.training.teacher import half, taught, word_of


class SmallCNN(NeuralModel):
    """One strided convolution and one that halves, on the raw CIR; found by `bench search`.

    Source: the search of docs/search.md over a family of ours, which is REMnet (Angarano et al.
    2021) without residual paths. 16 filters of 7 taps every second of 96 samples, one block that
    halves, one output: 1 297 parameters. MAE, Adam with the rate falling to 0 along a half cosine.

    `distilled`: trained on the mean of the measured error and of what REMnet, fitted on the same
    rows, says (Hinton, Vinyals and Dean 2015): a teacher's answers are free of the rows' noise.
    Sizes as in `zoo.modules.small.Shape`.

    >>> import numpy as np
    >>> rng = np.random.default_rng(0)
    >>> X, y = rng.rayleigh(100, (40, 16)), rng.normal(0.1, 0.1, 40)
    >>> SmallCNN(samples=16, epochs=1, distilled=False).fit(X, y).predict(X[:3]).shape
    (3,)
    """

    def __init__(
        self,
        samples: int = 96,
        filters: int = 16,
        kernel: int = 7,
        stride: int = 2,
        blocks: int = 1,
        reduction: int = 0,
        hidden: int = 0,
        distilled: bool = True,
        dropout: float = 0.0,
        learning_rate: float = 3e-3,
        epochs: int = 20,
        batch_size: int = 64,
        random_state: int = 0,
    ) -> None:
        self.samples = samples
        self.filters = filters
        self.kernel = kernel
        self.stride = stride
        self.blocks = blocks
        self.reduction = reduction
        self.hidden = hidden
        self.distilled = distilled
        self.dropout = dropout
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
        """Train on CIRs [n, width] and errors [n] in metres; the teacher first, if there is one.

        `said_m` [n]: what `teacher()`, fitted on these rows, says of them, where that is known.
        Raises ValueError for rows that are too narrow, NaN or infinite, or do not match `y`.
        """
        if (teacher := self.teacher()) is None:
            return super().fit(X, y, progress=progress, groups=groups)
        if said_m is None:
            said_m = word_of(teacher, *self._training_rows(X, y), half(progress, 0.0))
            progress = half(progress, 0.5)
        return super().fit(X, taught(y, said_m), progress=progress, groups=groups)

    def teacher(self) -> REMnet | None:
        """Return the REMnet that teaches this network, None unless it is `distilled`."""
        return REMnet(random_state=self.random_state) if self.distilled else None

    def training_recipe(self) -> TrainingRecipe:
        """Return MAE, Adam at a falling rate."""
        return TrainingRecipe("mae", self.learning_rate, self.batch_size, self.epochs, decay=True)

    def shape(self) -> Shape:
        """Return the sizes of the network."""
        sizes = (self.samples, self.filters, self.kernel, self.stride, self.blocks)
        return Shape(*sizes, self.reduction, self.hidden)

    def _preparation(self, width: int) -> Preparation:
        return Preparation(Crop(width, 0, self.samples), GlobalScale())

    def _network(self, preparation: Preparation) -> nn.Module:
        return SmallNetwork(self.shape(), dropout=self.dropout, seed=self.random_state)

    def _trainer(self) -> Callable[..., TrainingLog]:
        return by_hand.train  # which trains plainly whatever is not written out
