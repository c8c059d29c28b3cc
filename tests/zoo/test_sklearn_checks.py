"""Every model passes scikit-learn's own checks of a regressor.

The checks bring toy tables of 1 to 20 columns, which models of a fixed width refuse by the width
rule (tests/zoo/test_models.py). `cir_samples=None`, "rows as they come", lifts just that, so that
all checks run on the very same code.
"""

from __future__ import annotations

from typing import Any

import pytest
from sklearn.base import BaseEstimator
from sklearn.utils.estimator_checks import check_regressors_train, parametrize_with_checks

from zoo import CNN1D, FeatureMLP, FeatureSVM, NoMitigation, REMnet

# one epoch keeps the checks fast; the fits below then show that training does reach the score
BRIEF = {"check_regressors_train": "one epoch is too short to score R2 > 0.5; trained longer below"}
MODELS = [
    NoMitigation(),
    FeatureMLP(cir_samples=None, noise_samples=1, hidden=8, epochs=1),
    FeatureSVM(cir_samples=None, noise_samples=1),
    REMnet(cir_samples=None, modules=1, filters=8, epochs=1),
    CNN1D(cir_samples=None, first_sample=0, epochs=1),
]


def expected_failures(model: Any) -> dict[str, str]:
    return BRIEF if isinstance(model, REMnet | CNN1D) else {}


@parametrize_with_checks(MODELS, expected_failed_checks=expected_failures)
def test_scikit_learn_check(estimator: BaseEstimator, check: Any) -> None:
    check(estimator)


@pytest.mark.parametrize(
    "model",
    [
        REMnet(
            cir_samples=None,
            modules=1,
            filters=8,
            dropout=0.0,
            learning_rate=2e-2,
            epochs=8,
            batch_size=16,
        ),
        CNN1D(cir_samples=None, first_sample=0, learning_rate=3e-3, epochs=15, batch_size=20),
    ],
)
def test_trained_long_enough_it_solves_the_toy_regression(model: Any) -> None:
    check_regressors_train(type(model).__name__, model)
