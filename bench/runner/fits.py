"""Fitting a model on every fold, reusing an earlier fit only where nothing has changed."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.files import atomic_path, cache_dir
from bench.plugins import Plugin
from bench.provenance import decisive_versions, model_code_hash
from bench.recordings.splits import Fold
from bench.runner.material import Material

if TYPE_CHECKING:
    from zoo.base import MitigationModel

Progress = Callable[[float], None]


def new_model(plugin: Plugin, seed: int) -> MitigationModel:
    """Return an unfitted model with its default parameters and that seed."""
    model: MitigationModel = plugin.load()()
    if "random_state" in model.get_params():
        model.set_params(random_state=seed)
    return model


def fit_fold(
    plugin: Plugin, material: Material, fold: int, seed: int, progress: Progress | None = None
) -> MitigationModel:
    """Return the model fitted on one fold's training rows, from the cache where it is there."""
    model = new_model(plugin, seed)
    train = material.split.folds[fold].train
    path = _cache_path(plugin, model, material, fold, seed)
    state = _read_state(path)
    if state is not None and model.restore_state(state):
        return model
    model.fit(material.cirs[train], material.errors_m[train], progress=progress)
    state = model.fitted_state()
    if state is not None:
        with atomic_path(path) as scratch, scratch.open("wb") as stream:
            np.savez(stream, **state)  # type: ignore[arg-type]
    return model


def _cache_path(
    plugin: Plugin, model: MitigationModel, material: Material, fold: int, seed: int
) -> Path:
    key: dict[str, Any] = {
        "model": plugin.target,
        "code": model_code_hash(plugin),
        "parameters": {name: repr(value) for name, value in sorted(model.get_params().items())},
        "data": material.fingerprint,
        "rows": _rows_hash(material.split.folds[fold]),
        "seed": seed,
        "versions": decisive_versions(),
    }
    digest = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()[:24]
    return cache_dir() / "fits" / f"{plugin.name}-{digest}.npz"


def _rows_hash(fold: Fold) -> str:
    return hashlib.sha256(np.ascontiguousarray(fold.train, np.int64).tobytes()).hexdigest()[:16]


def _read_state(path: Path) -> dict[str, Any] | None:
    """Return the arrays of an earlier fit; None where there is none or the file is damaged."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile):
        return None
