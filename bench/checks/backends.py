"""What every backend must keep to: it says what it skips, and agrees with what was fitted."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import get_args

import numpy as np

from backends.base import Artifact, Backend, Precision, TrainingData
from bench.checks.expect import expect
from bench.checks.models import sample_rows
from bench.plugins import load
from zoo.base import Floats, MitigationModel

WITHIN_M = {"fp32": 1e-4, "fp16": 2e-3, "int8": 0.05}
"""How far a prediction may be from the model's, in the mean, by the precision declared (metres)."""
MODELS = ("none", "svm", "mlp")  # a floor, a kernel machine, a network: seconds to fit


def check_backend(
    backend: Backend,
    models: Sequence[MitigationModel] | None = None,
    within_m: float | None = None,
) -> None:
    """Check a backend on fitted models, by default three quick ones of ours.

    Of each it says a reason to skip it, or builds one file that answers as the model does within
    `within_m` (the mean, in metres; None takes what suits its precision), the same again, for any
    number of rows, opened as another process would. It takes at least one.
    """
    expect(bool(backend.name and backend.opener), "a backend needs a name and an opener")
    expect(backend.precision in get_args(Precision), f"precision {backend.precision!r} is none")
    given, (X, y) = models or sample_models(), sample_rows(300)
    taken = [model for model in given if check_support(backend, model) is None]
    expect(bool(taken), f"{backend.name} skips every model: {_reasons(backend, given)}")
    limit_m = WITHIN_M[backend.precision] if within_m is None else within_m
    for model in taken:
        with TemporaryDirectory() as folder:
            path = Path(folder) / "model.bin"
            artifact = backend.build(model, TrainingData(X, y, seed=0), path)
            check_artifact(backend, artifact, path)
            check_agreement(artifact, model, X, limit_m)


def sample_models() -> list[MitigationModel]:
    """Return three models of ours, fitted on made-up rows."""
    rows = sample_rows(300)
    made: list[MitigationModel] = [load("models", name)() for name in MODELS]
    for model in made:
        if "epochs" in model.get_params():
            model.set_params(epochs=3)
    return [model.fit(*rows) for model in made]


def check_support(backend: Backend, model: MitigationModel) -> str | None:
    """Return why a backend skips a model, which must be words; None where it takes it."""
    reason = backend.supports(model)
    right = reason is None or (isinstance(reason, str) and len(reason) > 5)
    expect(right, f"{backend.name}: supports gave {reason!r}, expected None or a reason in words")
    return reason


def check_artifact(backend: Backend, artifact: Artifact, path: Path) -> None:
    """Check that what was built is the file asked for, as the backend declares it."""
    expect(artifact.path == path and path.is_file(), f"{backend.name} did not write {path.name}")
    expect(artifact.precision == backend.precision, f"{backend.name}: another precision was built")
    expect(artifact.opener == backend.opener, f"{backend.name}: another opener was given")


def check_agreement(artifact: Artifact, model: MitigationModel, X: Floats, within_m: float) -> None:
    """Check a file's answers against the fitted model's, row by row and for no rows at all."""
    asked = model.predict(X)
    said = artifact.predict(X)
    expect(said.shape == asked.shape, f"gave {said.shape}, expected {asked.shape}")
    expect(said.dtype == np.float32, f"gave {said.dtype}, expected float32")
    apart_m = float(np.abs(said - asked).mean())
    expect(apart_m <= within_m, f"{type(model).__name__}: {apart_m:g} m off, {within_m:g} allowed")
    expect(artifact.predict(X).tobytes() == said.tobytes(), "the same rows gave other bits")
    alone = np.concatenate([artifact.predict(row[None]) for row in X[:4]])
    expect(bool(np.allclose(alone, said[:4], atol=1e-4)), "a row alone gave another answer")
    expect(artifact.predict(X[:0]).shape == (0,), "no rows gave an answer")


def _reasons(backend: Backend, models: Sequence[MitigationModel]) -> str:
    return "; ".join(str(backend.supports(model)) for model in models)
