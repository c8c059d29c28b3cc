"""Fitting a model on every fold, reusing an earlier fit only where nothing has changed."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.files import cache_dir, in_turn
from bench.plugins import Plugin, named
from bench.provenance import decisive_versions, declared, json_digest, model_code_hash
from bench.recordings.splits import Fold, labelled_los
from bench.results import Training
from bench.runner.further import PACE, PASSES, STEPS, train_further
from bench.runner.inputs import rows_for
from bench.runner.kept_arrays import read_arrays, write_arrays
from bench.runner.material import Material
from bench.runner.training import told, training_of

if TYPE_CHECKING:
    from zoo.base import MitigationModel

Progress = Callable[[float], None]
State = dict[str, Any]
_TRAINING = "bench.training"


def new_model(plugin: Plugin, seed: int) -> MitigationModel:
    """Return an unfitted model with its default parameters and that seed."""
    model: MitigationModel = plugin.make()
    if "random_state" in model.get_params():
        model.set_params(random_state=seed)
    return model


def fit_fold(
    plugin: Plugin,
    material: Material,
    fold: int,
    seed: int,
    progress: Progress | None = None,
    model: MitigationModel | None = None,
) -> MitigationModel:
    """Return the model fitted on one fold's training rows, from the cache where it is there.

    `model`: an unfitted one of the plug-in's kind with this seed, to be fitted in place of a new
    one. Of processes that want the same fit at once, one makes it and the others wait.
    """
    model = new_model(plugin, seed) if model is None else model
    path, key = _place(plugin, model, material, fold, seed)
    if _taken(model, path, key):
        return model
    with in_turn(path):
        if not _taken(model, path, key):
            fit_on(model, material, fold, progress)
            if (state := state_of(model)) is not None:
                write_arrays(path, key, state)
    return model


def _taken(model: MitigationModel, path: Path, key: Mapping[str, Any]) -> bool:
    """Make a model what an earlier fit made it; False where there is none, or it cannot."""
    state = read_arrays(path, key)
    return state is not None and _restored(model, state)


def fit_on(
    model: MitigationModel, material: Material, fold: int, progress: Progress | None = None
) -> None:
    """Fit a model on one fold's training rows, or on those before them and further on these.

    What teaches it is fitted before, or taken from the cache of fits.
    """
    rows, errors_m = rows_for(material, model.reads), material.errors_m
    own = material.split.folds[fold]
    first = own.pretrain if len(own.pretrain) else own.train
    told_too = _told_too(model, material, first)
    if not len(own.pretrain) and (said_m := _said(model, material, fold, progress)) is not None:
        told_too["said_m"] = said_m
    model.fit(rows[first], errors_m[first], progress=progress, **told_too)
    if len(own.pretrain):
        train_further(model, rows[own.train], errors_m[own.train])


def _said(
    model: MitigationModel, material: Material, fold: int, progress: Progress | None
) -> NDArray[np.float32] | None:
    """Return what a model's teacher says of the training rows [n] in metres, None without one."""
    teacher = model.teacher() if "said_m" in inspect.signature(model.fit).parameters else None
    plugin = None if teacher is None else named("models", type(teacher))
    if teacher is None or plugin is None:
        return None
    seed = int(teacher.get_params().get("random_state") or 0)
    rows = rows_for(material, teacher.reads)[material.split.folds[fold].train]
    return fit_fold(plugin, material, fold, seed, progress, teacher).predict(rows)


def _told_too(
    model: MitigationModel, material: Material, rows: NDArray[np.intp]
) -> dict[str, NDArray[Any]]:
    """Return links and lines of sight of training rows, where a model's `fit` wants them."""
    known = {"groups": material.links, "los": labelled_los(material.recordings)}
    wanted = inspect.signature(model.fit).parameters
    return {name: values[rows] for name, values in known.items() if name in wanted}


def place_of(
    plugin: Plugin, material: Material, fold: int, seed: int
) -> tuple[Path, dict[str, Any]]:
    """Return the file that a fit is kept in, and all that it depends on."""
    return _place(plugin, new_model(plugin, seed), material, fold, seed)


def _place(
    plugin: Plugin, model: MitigationModel, material: Material, fold: int, seed: int
) -> tuple[Path, dict[str, Any]]:
    key = _key(plugin, model, material, fold, seed)
    return cache_dir() / "fits" / f"{plugin.name}-{json_digest(key, 24)}.npz", key


def is_kept(path: Path, key: Mapping[str, Any]) -> bool:
    """Return True where a fit is kept that can be believed."""
    return read_arrays(path, key) is not None


def state_of(model: MitigationModel) -> State | None:
    """Return a fitted model's arrays with how it was trained, None where it has none."""
    state = model.fitted_state()
    return None if state is None else {**state, _TRAINING: told(training_of(model))}


def _restored(model: MitigationModel, state: State) -> bool:
    """Make a model what an earlier fit made it, with how it was trained; False where it cannot."""
    training = Training(**json.loads(str(state.pop(_TRAINING))))
    if not model.restore_state(state):
        return False
    model.training_log_ = training
    return True


def _key(
    plugin: Plugin, model: MitigationModel, material: Material, fold: int, seed: int
) -> dict[str, Any]:
    """Return all that a fit depends on."""
    says = declared(plugin)
    return {
        "model": plugin.target,
        "code": model_code_hash(plugin),
        "parameters": {name: repr(value) for name, value in sorted(model.get_params().items())},
        "data": material.fingerprint,
        "rows": _rows_hash(material.split.folds[fold]),
        "seed": seed,
        "versions": decisive_versions(says.rests_on),
        "declared": says.cache_key,
        "threads": says.threads,
    }


def _rows_hash(fold: Fold) -> str:
    rows = [np.ascontiguousarray(part, np.int64).tobytes() for part in (fold.train, fold.pretrain)]
    return hashlib.sha256(
        f"{STEPS} {PASSES} {PACE}".encode().join(rows) if rows[1] else rows[0]
    ).hexdigest()[:16]
