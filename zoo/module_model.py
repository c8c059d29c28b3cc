"""What every built-in model shares: a fit is one torch module, and predict runs it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any, NamedTuple, Self

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from sklearn.utils.validation import check_is_fitted, validate_data
from torch import Tensor, nn

from zoo.base import Floats, MitigationModel, Progress, TrainingRecipe
from zoo.modules.preparation import Preparation, apply_in_blocks
from zoo.training.eager import train
from zoo.training.recipe import TrainingLog


class RangeErrorModule(nn.Module):
    """A fitted model as one module: raw CIRs [n, width] -> range errors [n] in metres."""

    def __init__(self, preparation: Preparation, network: nn.Module) -> None:
        super().__init__()
        self.preparation, self.network = preparation, network

    def forward(self, x: Tensor) -> Tensor:
        """Return the errors [n] in metres."""
        error: Tensor = self.network(self.preparation(x))
        return error


class ModuleModel(MitigationModel):
    """A model whose fit is a torch module `module_`; predict and to_module are the same sums."""

    module_: nn.Module

    def predict(self, X: ArrayLike) -> Floats:
        """Return the predicted error [n] in metres for CIRs [n, n_features_in_].

        Raises ValueError for rows of another width or with NaN or infinity.
        """
        check_is_fitted(self)
        errors: Floats = apply_in_blocks(self.module_, self._known_rows(X)).numpy()
        return errors

    def _known_rows(self, X: ArrayLike) -> Floats:
        rows: Floats = validate_data(self, X, dtype=np.float32, reset=False)
        return rows

    def to_module(self) -> nn.Module:
        """Return a copy of the fitted module in eval mode: [n, n_features_in_] -> [n] metres."""
        check_is_fitted(self)
        return deepcopy(self.module_).eval()

    def fitted_state(self) -> dict[str, NDArray[Any]]:
        """Return the fit as plain arrays: the module's state and the width of the rows."""
        check_is_fitted(self)
        state = {name: value.numpy().copy() for name, value in self.module_.state_dict().items()}
        return {**state, "n_features_in_": np.array(self.n_features_in_)}

    def restore_state(self, state: Mapping[str, NDArray[Any]]) -> bool:
        """Become fitted from `fitted_state()`'s arrays; False where they do not suit."""
        try:
            weights = {name: torch.tensor(state[name]) for name in state}
            width = int(weights.pop("n_features_in_"))
            module = self._skeleton(width, weights)
            module.load_state_dict(weights)
        except (KeyError, ValueError, TypeError, RuntimeError):
            return False
        self.module_, self.n_features_in_ = module.eval(), width
        return True

    @abstractmethod
    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        """Return the module for rows of `width`, ready to load `weights`."""

    def _training_rows(self, X: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
        rows, errors = validate_data(self, X, y, dtype=np.float32, y_numeric=True)
        return rows, np.asarray(errors, np.float32)


class Start(NamedTuple):
    """What training starts from: module with a fitted preparation, prepared rows, errors [n]."""

    module: Any
    rows: Floats
    errors_m: Floats
    width: int


class NeuralModel(ModuleModel):
    """A model trained by gradient descent: `_preparation`, `_network` and a recipe are enough.

    A fit depends on the rows, the parameters and `random_state` (an int) alone. `training_log_`
    says what the training did: engine, epochs, rows, seconds; a restored fit has none.
    """

    training_log_: TrainingLog
    learning_rate: float
    batch_size: int
    random_state: int

    @abstractmethod
    def training_recipe(self) -> TrainingRecipe:
        """Return loss, learning rate, batch size and epochs."""

    @abstractmethod
    def _preparation(self, width: int) -> Any:
        """Return the preparation of rows of `width`; ValueError if they are too narrow."""

    @abstractmethod
    def _network(self, preparation: Preparation) -> nn.Module:
        """Return the network with its starting weights, drawn from `random_state`."""

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Train on CIRs [n, width] and errors [n] in metres; sets `module_`, `n_features_in_`.

        Raises ValueError for rows that are too narrow, NaN or infinite, or do not match `y`.
        """
        start = self.prepare(X, y)
        log = self._trainer()(
            start.module.network,
            start.rows,
            start.errors_m,
            self.seeded_recipe(),
            groups=groups,
            progress=progress,
        )
        return self.trained(start, log)

    def seeded_recipe(self) -> TrainingRecipe:
        """Return the recipe with this model's seed."""
        return replace(self.training_recipe(), seed=self.random_state)

    def trained(self, start: Start, log: TrainingLog) -> Self:
        """Take over a module that was trained, and the log of how."""
        self.module_, self.training_log_ = start.module.eval(), log
        return self

    def prepare(self, X: ArrayLike, y: ArrayLike) -> Start:
        """Return what training starts from; raises ValueError as `fit`."""
        rows, errors = self._training_rows(X, y)
        module = self.untrained(rows.shape[1])
        return Start(module, module.preparation.fit(rows), errors, rows.shape[1])

    def prepare_like(self, other: Start) -> Start:
        """Return a start on rows that a model differing in `random_state` alone has prepared."""
        preparation = deepcopy(other.module.preparation)
        self.n_features_in_ = other.width
        return other._replace(module=self._whole(preparation, self._network(preparation)))

    def untrained(self, width: int) -> Any:
        """Return the module for rows of `width`, with starting weights and an unfitted scaling."""
        preparation = self._preparation(width)
        return self._whole(preparation, self._network(preparation))

    def _whole(self, preparation: Any, network: nn.Module) -> Any:
        """Return preparation and network as one module."""
        return RangeErrorModule(preparation, network)

    def _trainer(self) -> Callable[..., TrainingLog]:
        """Return what trains: called like `zoo.training.eager.train`."""
        return train

    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        module: nn.Module = self.untrained(width)
        return module
