"""Every model of the zoo on every backend that makes a file, as C: it gives what the runtime gives.

Three minutes of processor time, most of it torch's exporter; tests/backends/c has the operators.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from every_model import MODELS, ROWS, TEST, columns_of, fit

from backends.base import TrainingData
from backends.c.compile import QUICK, missing_compiler
from backends.c.emit import generate
from backends.c.run import load
from backends.fp16 import Fp16Backend
from backends.fp32 import Fp32Backend
from backends.graph import GraphBackend
from backends.int8 import Int8Backend
from backends.ort import open_optimised
from backends.qat import QatBackend

pytestmark = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
BACKENDS = [Fp32Backend(), GraphBackend(), Fp16Backend(), Int8Backend(), QatBackend()]


@pytest.fixture(scope="module", params=MODELS)
def fitted(request: pytest.FixtureRequest):
    return request.param, fit(request.param)


@pytest.mark.parametrize("backend", BACKENDS, ids=lambda one: one.name)
def test_c_gives_what_the_runtime_gives(fitted, backend, tmp_path: Path) -> None:
    name, model = fitted
    if reason := backend.supports(model):
        pytest.skip(reason)
    columns = columns_of(name)
    data = TrainingData(ROWS[0][:, columns], ROWS[1], seed=0)
    path = backend.build(model, data, tmp_path / "model.onnx").path
    rows = np.ascontiguousarray(TEST[:, columns])
    expected = open_optimised(path)(rows)
    for how in ("float", "fixed") if backend.precision == "int8" else ("float",):
        found = load(generate(path, backend.precision, how), QUICK)(rows)
        gaps = np.abs(found - expected)
        print(f"\n{name} {backend.name} {how}: {np.mean(gaps == 0):.3f} equal, {gaps.max():.2g} m")
        # a tree, or rounding to 8 bits, turns the last bit of a feature into a step now and then
        assert np.quantile(gaps, 0.98) <= (2e-3 if backend.precision == "int8" else 1e-5)
    assert name in ("none", "constant") or len(np.unique(expected)) > 1
