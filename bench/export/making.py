"""Fitting and building what was not run yet; a pair that cannot be is refused before the fit."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from backends.base import Artifact, Backend, TrainingData
from bench.errors import BenchError
from bench.export.built import builder_of, keep_built
from bench.plugins import Plugin
from bench.runner.fits import fit_fold, new_model
from bench.runner.inputs import missing, rows_for
from bench.runner.keys import run_key
from bench.runner.material import Material

if TYPE_CHECKING:
    from zoo.base import MitigationModel

Tell = Callable[[str], None]
TRIAL_ROWS = 300


def made(model: Plugin, backend: Plugin, material: Material, path: Path, tell: Tell) -> Artifact:
    """Return a model's artifact on a backend at `path`, fitted on the first fold with seed 0.

    Raises BenchError where the recordings cannot feed it, or the backend does not take it.
    """
    adapter: Backend = builder_of(backend).make()
    if reason := missing(material, model.load()) or _declined(model, adapter, material):
        raise BenchError(f"{backend.name} does not take {model.name}: {reason}")
    tell(f"fitting {model.name}")
    fitted = fit_fold(model, material, 0, 0)
    if reason := adapter.supports(fitted):
        raise BenchError(f"{backend.name} does not take {model.name}: {reason}")
    tell(f"building {backend.name}")
    artifact = _built(adapter, fitted, material, path)
    keep_built(artifact, run_key(model, backend, material, 0))
    return artifact


def _declined(model: Plugin, adapter: Backend, material: Material) -> str | None:
    """Return why a backend does not take a model, asked of a fit on few rows, or None.

    A model trained by gradient descent has weights, and is not soon fitted: it is not tried.
    """
    trial: MitigationModel = new_model(model, 0)
    if trial.training_recipe() is not None:
        return None
    train = material.split.folds[0].train
    few = train[np.linspace(0, len(train) - 1, min(TRIAL_ROWS, len(train))).astype(int)]
    with suppress(Exception):  # the fit on all rows says what is wrong
        trial.fit(rows_for(material, trial.reads)[few], material.errors_m[few])
        return adapter.supports(trial)
    return None


def _built(adapter: Backend, fitted: MitigationModel, material: Material, path: Path) -> Artifact:
    train = material.split.folds[0].train
    rows = TrainingData(rows_for(material, fitted.reads)[train], material.errors_m[train], 0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # exporters warn of their own internals
        try:
            return adapter.build(fitted, rows, path)
        except (ValueError, RuntimeError) as problem:
            raise BenchError(str(problem).splitlines()[0].replace(f"{path}: ", "")) from problem
