"""Small fitted models, and every backend's artifact of each, built once per test session."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from backends.base import Artifact, TrainingData
from backends.fp16 import Fp16Backend
from backends.fp32 import Fp32Backend
from backends.graph import GraphBackend
from backends.int8 import Int8Backend
from backends.qat import QatBackend
from zoo.base import Floats, MitigationModel
from zoo.cnn1d import CNN1D
from zoo.mlp import FeatureMLP
from zoo.none import NoMitigation
from zoo.remnet import REMnet
from zoo.svm import FeatureSVM

WIDTH = 157
MODELS: dict[str, Callable[[], MitigationModel]] = {
    "remnet": lambda: REMnet(epochs=20, learning_rate=2e-3),
    "cnn1d": lambda: CNN1D(epochs=8, learning_rate=2e-3),
    "svm": lambda: FeatureSVM(),
    "mlp": lambda: FeatureMLP(epochs=20),
    "none": lambda: NoMitigation(),
}
KINDS = (Fp32Backend, GraphBackend, Fp16Backend, Int8Backend, QatBackend)
BACKENDS = {kind.name: kind for kind in KINDS}


def made_up_cirs(rows: int, seed: int) -> tuple[Floats, Floats]:
    """Return CIRs [rows, 157] whose early energy and decay tell the error [rows] in metres.

    The direct path is weakened and a later one is detected: the more so, the longer the error.
    """
    rng = np.random.default_rng(seed)
    blocked = rng.random((rows, 1)).astype(np.float32)
    time = np.arange(WIDTH) - 5.0
    tail = np.where(time >= 0, np.exp(-time / (6 + 25 * blocked)), 0)
    early = (0.05 + 0.5 * blocked) * np.exp(-((time + 2) ** 2) / 4)
    level = 12_000 * (1.2 - blocked) * (tail + early)
    cirs = rng.rayleigh(80, (rows, WIDTH)) + level * rng.rayleigh(0.8, (rows, WIDTH))
    errors = 0.35 * blocked[:, 0] - 0.05 + rng.normal(0, 0.02, rows)
    return cirs.astype(np.float32), errors.astype(np.float32)


@pytest.fixture(scope="session")
def training() -> TrainingData:
    return TrainingData(*made_up_cirs(1500, 1), seed=3)


@pytest.fixture(scope="session")
def test_rows() -> tuple[Floats, Floats]:
    return made_up_cirs(600, 2)


@pytest.fixture(scope="session")
def fitted(training: TrainingData) -> Callable[[str], MitigationModel]:
    """Return a function from a model's name to the model, fitted on first use."""
    models: dict[str, MitigationModel] = {}

    def get(name: str) -> MitigationModel:
        if name not in models:
            models[name] = MODELS[name]().fit(training.cirs, training.errors_m)
        return models[name]

    return get


Build = Callable[[str, str], Artifact]


@pytest.fixture(scope="session")
def built(
    fitted: Callable[[str], MitigationModel],
    training: TrainingData,
    tmp_path_factory: pytest.TempPathFactory,
) -> Build:
    """Return a function (model, backend) -> artifact, built on first use.

    Skips the test, with the backend's reason, where the backend does not take the model.
    """
    folder: Path = tmp_path_factory.mktemp("artifacts")
    artifacts: dict[tuple[str, str], Artifact | str] = {}

    def get(model: str, backend: str) -> Artifact:
        if (model, backend) not in artifacts:
            kind, path = BACKENDS[backend](), folder / f"{model}.{backend}.onnx"
            reason = kind.supports(fitted(model))
            artifacts[model, backend] = reason or kind.build(fitted(model), training, path)
        found = artifacts[model, backend]
        if isinstance(found, str):
            pytest.skip(found)
        return found

    return get
