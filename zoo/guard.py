"""Do no harm: a model's correction shrunk until lines of sight are no worse than uncorrected."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any, ClassVar, Self

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor, nn

from zoo.base import Floats, MitigationModel, Progress, TrainingRecipe
from zoo.modules.trees import TreeEnsemble

FACTORS = tuple(np.linspace(0, 1, 11).round(1).tolist())
FOLDS = 3
_FACTOR = "guard_factor"


class Guarded(MitigationModel):
    """A model whose predictions are multiplied by one factor from 0 to 1, chosen on unseen links.

    The model is fitted `FOLDS` times without a third of the links each, and predicts those. Of the
    factors that leave line-of-sight links, on average over them, no worse than uncorrected, the one
    with the least mean error over all links is taken; 0, no correction, is always allowed. Then the
    model is fitted on everything. Where no row is labelled line of sight there is nothing to
    protect, and the factor is 1. It costs three more fits.

    Made by `guarded(REMnet)`, which gives a class that reads what REMnet reads.
    """

    base: ClassVar[type[MitigationModel]]

    def __init__(self, random_state: int = 0) -> None:
        self.random_state = random_state

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
        los: ArrayLike | None = None,
    ) -> Self:
        """Fit on rows [n, width] and errors [n] in metres; `los` [n] marks lines of sight."""
        rows, errors = np.asarray(X), np.asarray(y, np.float64)
        links = np.arange(len(rows)) if groups is None else np.asarray(groups)
        clear = np.zeros(len(rows), np.bool_) if los is None else np.asarray(los, np.bool_)
        self.factor_ = 1.0
        if clear.any() and len(np.unique(links)) >= FOLDS:
            predicted = self._unseen(rows, errors, links)
            self.factor_ = chosen_factor(errors, predicted, links, clear)
        self.model_ = self._new().fit(X, y, progress=progress, groups=groups)
        self.n_features_in_ = self.model_.n_features_in_
        return self

    def _new(self) -> Any:
        model = self.base()
        if "random_state" in model.get_params():
            model.set_params(random_state=self.random_state)
        return model

    def _unseen(
        self, rows: Any, errors: NDArray[np.float64], links: NDArray[Any]
    ) -> NDArray[np.float64]:
        """Return the prediction of every row [n] by a model that has not seen its link."""
        names, link = np.unique(links, return_inverse=True)
        fold = np.random.default_rng([self.random_state, 2]).permutation(len(names))[link] % FOLDS
        predicted = np.empty(len(errors))
        for number in range(FOLDS):
            learn, held = fold != number, fold == number
            model = self._new().fit(rows[learn], errors[learn], groups=links[learn])
            predicted[held] = model.predict(rows[held])
        return predicted

    def predict(self, X: ArrayLike) -> Floats:
        """Return the predicted error [n] in metres, shrunk."""
        errors: Floats = np.float32(self.factor_) * self.model_.predict(X)
        return errors

    def to_module(self) -> nn.Module:
        """Return the model's module with the factor in it."""
        return shrunk(self.model_.to_module(), self.factor_)

    def training_recipe(self) -> TrainingRecipe | None:
        """Return the model's own recipe."""
        model = self.model_ if hasattr(self, "model_") else self._new()
        recipe: TrainingRecipe | None = model.training_recipe()
        return recipe

    def fitted_state(self) -> dict[str, NDArray[Any]] | None:
        """Return the model's arrays and the factor."""
        state = self.model_.fitted_state()
        return None if state is None else {**state, _FACTOR: np.array(self.factor_)}

    def restore_state(self, state: Mapping[str, NDArray[Any]]) -> bool:
        """Become fitted from `fitted_state()`'s arrays; False where they do not suit."""
        model, own = self._new(), dict(state)
        factor = own.pop(_FACTOR, None)
        if factor is None or not model.restore_state(own):
            return False
        self.model_, self.factor_ = model, float(factor)
        self.n_features_in_ = model.n_features_in_
        return True


def guarded(base: type[MitigationModel]) -> type[Guarded]:
    """Return the guarded class of a model class."""
    takes = {name: getattr(base, name) for name in ("reads", "does_without", "rests_on")}
    body = {"base": base, "__doc__": Guarded.__doc__, **takes}
    return type(f"Guarded{base.__name__}", (Guarded,), body)


def chosen_factor(
    errors: NDArray[np.float64],
    predicted: NDArray[np.float64],
    links: NDArray[Any],
    los: NDArray[np.bool_],
) -> float:
    """Return the factor for errors [n] and predictions [n] in metres of rows on unseen links."""
    left = np.array([np.abs(errors - factor * predicted) for factor in FACTORS])
    clear, every = (_over_links(left[:, rows], links[rows]) for rows in (los, los | True))
    allowed = np.flatnonzero(clear <= clear[0] + 1e-9)
    return float(FACTORS[allowed[np.argmin(every[allowed])]])


def _over_links(values: NDArray[np.float64], links: NDArray[Any]) -> NDArray[np.float64]:
    """Return the mean over links of each link's mean, for every factor [f]."""
    _, link = np.unique(links, return_inverse=True)
    sums = np.array([np.bincount(link, row) for row in values])
    means: NDArray[np.float64] = (sums / np.bincount(link)).mean(axis=1)
    return means


class Shrunk(nn.Module):
    """A module's predictions times a factor; of a pair, the deviation stays."""

    def __init__(self, module: nn.Module, factor: float) -> None:
        super().__init__()
        self.module = module
        self.register_buffer("factor", torch.tensor(factor))
        if hasattr(module, "inputs"):
            self.inputs = module.inputs

    def forward(
        self, a: Tensor, b: Tensor | None = None, c: Tensor | None = None, d: Tensor | None = None
    ) -> Tensor:
        """Return errors [n] in metres."""
        blocks = [block for block in (a, b, c, d) if block is not None]
        result = self.module(*blocks)
        error: Tensor = result[0] if isinstance(result, tuple) else result
        return error * self.factor  # type: ignore[operator]  # a buffer


def shrunk(module: nn.Module, factor: float) -> nn.Module:
    """Return a module with the factor in it; trees take it into their leaves, and stay trees."""
    network = getattr(module, "network", None)
    if not isinstance(network, TreeEnsemble):
        return Shrunk(module, factor).eval()
    scaled = deepcopy(module)
    for name in ("value", "base"):
        getattr(scaled.network, name).mul_(factor)
    return scaled.eval()
