"""The least a model from elsewhere must write, and what it is given for it."""

from __future__ import annotations

from typing import Any

import numpy as np
from torch import nn

from zoo import MitigationModel


class Mean(MitigationModel):
    """Predicts the mean error; neither trained by gradient descent nor kept in a cache."""

    def fit(self, X: Any, y: Any, progress: Any = None) -> Mean:
        self.mean_ = np.float32(np.mean(y))
        return self

    def predict(self, X: Any) -> Any:
        return np.full(len(X), self.mean_)

    def to_module(self) -> nn.Module:
        raise NotImplementedError


def test_recipe_and_state_are_optional() -> None:
    model = Mean().fit(np.ones((2, 157)), [0.1, 0.3])
    assert model.training_recipe() is None
    assert model.fitted_state() is None
    assert not model.restore_state({"mean_": np.zeros(1)})


def test_it_is_scored_as_a_regressor() -> None:
    assert Mean().fit(np.ones((2, 157)), [0.1, 0.3]).score(np.ones((2, 157)), [0.1, 0.3]) < 1e-6
