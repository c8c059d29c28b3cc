"""A guarded model: lines of sight on unseen links are not made worse."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from blocks import CIR, made_up_blocks

from backends.base import TrainingData
from backends.fp32 import Fp32Backend
from zoo import Constant, GradientBoosting, NoMitigation
from zoo.guard import FACTORS, Guarded, chosen_factor, guarded


def test_the_factor_protects_los_and_is_the_best_of_those_that_do() -> None:
    links = np.repeat(np.arange(4), 5)
    los = links < 1
    errors = np.where(los, 0.1, 0.5)
    flat = np.full(20, 0.4)  # as a constant: far too much for LoS
    factor = chosen_factor(errors, flat, links, los)
    assert factor == 0.5  # at 0.5 LoS reads 0.1 short, as long as it read before
    exact = chosen_factor(errors, errors, links, los)
    assert exact == 1.0
    harmful = chosen_factor(np.where(los, -0.1, 0.5), flat, links, los)
    assert harmful == 0.0


def test_links_count_alike() -> None:
    """One LoS link of many rows must not outvote two that are harmed."""
    links = np.array([0] * 50 + [1, 2, 3])
    los = links < 3
    errors = np.where(links == 0, 0.4, np.where(links == 3, 0.4, 0.0))
    assert chosen_factor(errors, np.full(53, 0.4), links, los) < 1.0


def harmful() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Half of the links are clear and read right, half long; nothing in a row tells which."""
    rng = np.random.default_rng(0)
    links = np.repeat(np.arange(30), 10)
    los = links % 2 == 0
    errors = np.where(los, 0.0, 0.3) + rng.normal(0, 0.02, 300)
    return rng.uniform(2, 9, (300, 1)), errors, links, los


def test_a_constant_is_shrunk_to_nothing_where_it_harms() -> None:
    X, errors, links, los = harmful()
    model = guarded(Constant)().fit(X, errors, groups=links, los=los)
    assert isinstance(model, Guarded)
    assert model.factor_ < 0.3
    left = np.abs(errors - model.predict(X))[los].mean()
    assert left <= np.abs(errors)[los].mean() + 0.03
    assert guarded(Constant)().fit(X, errors, groups=links).factor_ == 1.0  # nothing is labelled


def test_it_is_a_model_like_its_base(tmp_path: Path) -> None:
    X, errors, links = made_up_blocks(200, seed=1)
    los = errors < np.median(errors)
    kind = guarded(GradientBoosting)
    assert (kind.reads, kind.__name__) == (GradientBoosting.reads, "GuardedGradientBoosting")
    model = kind().fit(X, errors, groups=links, los=los)
    assert model.factor_ in FACTORS
    copy = kind()
    assert copy.restore_state(model.fitted_state())
    np.testing.assert_array_equal(copy.predict(X), model.predict(X))
    assert not kind().restore_state({})
    model.factor_ = 0.5
    data = TrainingData(X, errors, seed=0)
    artifact = Fp32Backend().build(model, data, tmp_path / "model.onnx")  # trees stay trees
    gap = np.abs(artifact.predict(X) - 0.5 * model.model_.predict(X))
    assert (gap > 1e-5).mean() < 0.01


@pytest.mark.parametrize("factor", [0.0, 0.3])
def test_the_factor_is_in_the_module(factor: float) -> None:
    model = guarded(NoMitigation)().fit(np.ones((4, CIR)), np.ones(4))
    model.factor_ = factor
    with torch.no_grad():
        assert model.to_module()(torch.ones(2, CIR)).tolist() == [0, 0]
