"""The support vector machine: its module against scikit-learn's, and how rows are thinned."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer, StandardScaler
from sklearn.svm import SVR

from zoo import FeatureSVM
from zoo.modules.features import marano_features
from zoo.svm import RbfExpansion

Rows = tuple[NDArray[np.float32], NDArray[np.float32]]


@pytest.fixture(scope="module")
def rows() -> Rows:
    """Made-up decaying pulses with the decay tied to the error: not a simulation."""
    generator = np.random.default_rng(5)
    errors = generator.gamma(2, 0.08, 1500)
    delay = np.arange(157) - 5
    decay = np.where(delay < 0, 0, np.exp(-delay / (8 + 60 * errors[:, None])))
    level = generator.uniform(500, 9000, (1500, 1)) * decay
    cirs = np.hypot(*generator.normal(0, 90 + level, (2, 1500, 157)))
    return cirs.astype(np.float32), (errors + generator.normal(0, 0.05, 1500)).astype(np.float32)


def test_it_predicts_what_scikit_learns_own_pipeline_predicts(rows: Rows) -> None:
    train, test = slice(0, 1000), slice(1000, None)
    reference = make_pipeline(
        FunctionTransformer(marano_features),
        StandardScaler(),
        SVR(C=2.0, gamma=0.3, epsilon=0.02, tol=1e-5),
    ).fit(rows[0][train], rows[1][train])
    model = FeatureSVM(c=2.0, gamma=0.3, epsilon=0.02).fit(rows[0][train], rows[1][train])
    expected = reference.predict(rows[0][test])
    assert expected.std() > 0.02  # it has learnt something, so that agreeing means something
    np.testing.assert_allclose(model.predict(rows[0][test]), expected, atol=1e-4)


def test_it_learns_the_decay(rows: Rows) -> None:
    model = FeatureSVM().fit(rows[0][:1000], rows[1][:1000])
    assert model.score(rows[0][1000:], rows[1][1000:]) > 0.3


def test_the_expansion_is_careful_far_from_the_origin() -> None:
    generator = np.random.default_rng(0)
    vectors, weights = generator.normal(300, 1, (500, 6)), generator.normal(0, 1, 500)
    module = RbfExpansion(500, 6, 0.2)
    with torch.no_grad():
        module.vectors.copy_(torch.from_numpy(vectors.T))
        module.total.weight.copy_(torch.from_numpy(weights[None]))
        module.total.bias.fill_(0.1)
        points = (vectors[:50] + 0.3).astype(np.float32)
        errors = module(torch.from_numpy(points)).numpy()
    stored = vectors.astype(np.float32).astype(np.float64)
    squares = ((points[:, None].astype(np.float64) - stored) ** 2).sum(2)
    np.testing.assert_allclose(errors, np.exp(-0.2 * squares) @ weights + 0.1, atol=1e-5)


def test_rows_are_thinned_by_the_seed_alone(rows: Rows) -> None:
    def predicted(**options: int) -> NDArray[np.float32]:
        return FeatureSVM(max_train_rows=200, **options).fit(*rows).predict(rows[0][:50])

    np.testing.assert_array_equal(predicted(), predicted(random_state=0))
    assert not np.allclose(predicted(), predicted(random_state=1))


def test_support_vectors_are_at_most_the_rows_kept(rows: Rows) -> None:
    model = FeatureSVM(max_train_rows=200).fit(*rows)
    assert model.to_module().network.vectors.shape[1] <= 200


def test_float32_keeps_the_sum_of_opposing_weights_to_a_hundredth_of_a_millimetre() -> None:
    generator = np.random.default_rng(7)
    links = np.repeat(np.arange(30), 60)  # rows of one link follow one another, as in recordings
    decay = np.exp(-np.clip(np.arange(157) - 5, 0, None) / (5 + links[:, None]))
    cirs = generator.rayleigh(60 + 9000 * decay).astype(np.float32)
    errors = (0.05 * links + generator.choice([-0.3, 0.4], 30)[links]).astype(np.float32)
    module = FeatureSVM().fit(cirs, errors).to_module()
    with torch.no_grad():
        features = module.preparation(torch.from_numpy(cirs))
        single = module.network(features).numpy()
        double = module.network.double()(features.double()).numpy()
    np.testing.assert_allclose(single, double, atol=1e-5)
