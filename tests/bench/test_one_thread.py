"""Diagnoses use one thread: their trees and matrices are too small for more."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pandas as pd
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from bench.discrepancy import method
from bench.discrepancy.compare.calibration import separability
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit import reference_regression
from bench.discrepancy.fit.reference_regression import corrected
from bench.parallel import one_blas_thread, one_openmp_thread
from bench.runner import diagnosis

ROWS = pd.DataFrame({"link": ["a", "b"], "range_m": [5.1, 5.2], "true_range_m": 5.0})
LINKS = np.repeat(np.arange(10), 8)
VALUES = np.random.default_rng(0).normal(0, 0.01, (5, len(LINKS), 1))
MADE = Ensemble((RANGE,), ("m",), VALUES, LINKS)
KNOWN = Covariates({"x": np.linspace(0, 1, len(LINKS))}, {})


def pools(kind: str) -> set[int]:
    """Return how many threads the loaded pools of a kind have."""
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == kind}


def test_small_trees_and_matrices_use_one_thread_and_then_as_many_as_before() -> None:
    for kind, one_thread in (("openmp", one_openmp_thread), ("blas", one_blas_thread)):
        with threadpool_limits(2), one_thread():
            assert pools(kind) == {1}
        with threadpool_limits(2):
            with one_thread():
                pass
            assert pools(kind) == {2}


def test_diagnoses_use_one_thread_for_matrices(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[set[int]] = []
    monkeypatch.setattr(method, "diagnose", lambda *_, **__: seen.append(pools("blas")))
    with threadpool_limits(2):
        diagnosis.diagnose(ROWS, ROWS)
    assert seen == [{1}]


@pytest.mark.parametrize("grower", ["calibration", "regression"])
def test_trees_of_diagnoses_grow_in_one_thread(
    grower: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[set[int]] = []

    def watched(*_: object, **__: object) -> tuple[float, float]:
        seen.append(pools("openmp"))
        raise StopIteration

    with threadpool_limits(2), suppress(StopIteration):
        if grower == "calibration":
            monkeypatch.setattr("sklearn.model_selection.cross_val_predict", watched)
            separability(MADE, 0)
        else:
            monkeypatch.setattr(reference_regression, "_fitted", watched)
            corrected(MADE, KNOWN, MADE, KNOWN, (RANGE,))
    assert seen == [{1}]
