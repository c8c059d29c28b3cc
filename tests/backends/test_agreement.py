"""Every backend computes what the fitted model computes, within what its precision allows."""

from __future__ import annotations

import numpy as np
import pytest

from backends.base import Floats

MODELS = ["remnet", "cnn1d", "svm", "mlp", "none"]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("backend", "within_m"), [("fp32", 1e-5), ("graph", 1e-5), ("fp16", 1e-3)])
def test_float_backends_agree_with_torch(
    model: str, backend: str, within_m: float, fitted, built, test_rows: tuple[Floats, Floats]
) -> None:
    expected = fitted(model).predict(test_rows[0])
    answer = built(model, backend).predict(test_rows[0])
    assert answer.dtype == np.float32
    assert answer.shape == expected.shape
    assert np.abs(answer - expected).max() <= within_m
    if model != "none":
        assert expected.std() > 0.03, "a model that says the same for every row proves nothing"


@pytest.mark.parametrize("backend", ["fp32", "graph", "fp16"])
def test_an_all_zero_cir_and_a_single_row_agree(backend: str, fitted, built) -> None:
    for row in (np.zeros((1, 157), np.float32), np.full((1, 157), 3e4, np.float32)):
        expected = fitted("svm").predict(row)
        assert built("svm", backend).predict(row) == pytest.approx(expected, abs=1e-3)


def test_any_number_of_rows_including_none(built, test_rows: tuple[Floats, Floats]) -> None:
    artifact = built("mlp", "graph")
    whole = artifact.predict(test_rows[0])
    assert artifact.predict(test_rows[0], batch_rows=7) == pytest.approx(whole, abs=1e-6)
    assert artifact.predict(test_rows[0][:0]).shape == (0,)


def test_the_same_input_gives_the_same_bits(built, test_rows: tuple[Floats, Floats]) -> None:
    artifact = built("remnet", "graph")
    first, second = (artifact.predict(test_rows[0]) for _ in range(2))
    assert first.tobytes() == second.tobytes()
