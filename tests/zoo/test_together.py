"""Networks fitted together end as if fitted alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from sklearn.base import clone

from zoo import CNN1D, FeatureMLP, REMnet
from zoo.base import Floats
from zoo.module_model import NeuralModel
from zoo.training.together import fit_together

MAKERS: dict[str, Callable[[int], NeuralModel]] = {
    "mlp": lambda seed: FeatureMLP(epochs=2, random_state=seed),
    "cnn1d": lambda seed: CNN1D(epochs=1, batch_size=50, random_state=seed),
    "remnet": lambda seed: REMnet(epochs=1, random_state=seed),
}


def made_up(seed: int, rows: int = 120) -> tuple[Floats, Floats]:
    generator = np.random.default_rng(seed)
    cirs = generator.rayleigh(100, (rows, 157)).astype(np.float32)
    return cirs, (cirs[:, 9] / 1000).astype(np.float32)


@pytest.mark.parametrize("name", MAKERS)
def test_each_seed_ends_as_if_fitted_alone(name: str) -> None:
    X, y = made_up(0)
    models = [MAKERS[name](seed) for seed in range(3)]
    fit_together(models, [X] * 3, [y] * 3)
    for model in models:
        alone = clone(model).fit(X, y)
        np.testing.assert_allclose(model.predict(X), alone.predict(X), atol=1e-4)
        assert model.n_features_in_ == alone.n_features_in_


def test_each_may_have_rows_of_its_own() -> None:
    tables = [made_up(0), made_up(1, rows=90)]
    models = [FeatureMLP(epochs=1), FeatureMLP(epochs=1)]
    fit_together(models, [X for X, _ in tables], [y for _, y in tables])
    for model, (X, y) in zip(models, tables, strict=True):
        np.testing.assert_allclose(model.predict(X), clone(model).fit(X, y).predict(X), atol=1e-4)


def test_each_may_have_settings_of_its_own() -> None:
    X, y = made_up(0)
    models = [REMnet(cir_samples=samples, epochs=1) for samples in (16, 157)]
    fit_together(models, [X] * 2, [y] * 2)
    for model in models:
        np.testing.assert_allclose(model.predict(X), clone(model).fit(X, y).predict(X), atol=1e-4)


def test_different_recipes_are_refused() -> None:
    X, y = made_up(0)
    with pytest.raises(ValueError, match="2 training recipes"):
        fit_together([FeatureMLP(epochs=1), FeatureMLP(epochs=2)], [X] * 2, [y] * 2)


def test_nothing_to_fit_is_nothing_done() -> None:
    fit_together([], [], [])
