"""What is exported: a finished run's artifact where there is one, else one made now."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backends.base import Artifact, TrainingData
from backends.graph_file import load_graph
from backends.inputs import graph_inputs
from bench.errors import BenchError
from bench.files import read_json
from bench.plugins import find
from bench.results import RunRecord, from_json
from bench.runner.finished import artifact_of
from bench.runner.fits import fit_fold
from bench.runner.folder import ResultFolder
from bench.runner.inputs import rows_for
from bench.runner.keys import run_key
from bench.runner.material import Material, load_material

Tell = Callable[[str], None]
MOST_ROWS = 4096  # held-out rows that agreement is checked on


@dataclass(frozen=True)
class Chosen:
    """An artifact, where it came from, and held-out rows [n, width] to check it on."""

    artifact: Artifact
    model: str
    backend: str
    data: str
    simulated: bool
    cirs: NDArray[np.float32]


def from_run(run: str, results: Path, data: str | None = None) -> Chosen:
    """Return the first fold's artifact of a finished run, named by its id or the start of it.

    Raises BenchError where no run, or more than one, begins so, or its files are not what its
    record says.
    """
    record = _record(run, results)
    artifact, key = artifact_of(record, results), record.key
    material = load_material(data or key.data, key.split, key.data_fingerprint)
    return _chosen(artifact, key.model, key.backend, material)


def _record(run: str, results: Path) -> RunRecord:
    if not run.isalnum():
        raise BenchError(f"--run {run!r}: expected the hexadecimal id of a run")
    found = sorted((results / "runs").glob(f"{run}*.json"))
    if len(found) != 1:
        raise BenchError(f"--run {run}: {len(found)} runs under {results} begin so, expected one")
    record = from_json(RunRecord, read_json(found[0]))
    if record.digest() != found[0].stem or record.status != "ok":
        raise BenchError(f"{found[0]}: not a finished run of that id")
    return record


def from_fit(
    model: str, backend: str, data: str, results: Path, scratch: Path, tell: Tell
) -> Chosen:
    """Return a model's artifact on a backend: of a finished run under `results`, else made now.

    Trained on the first fold of the data's own split, seed 0, as `bench run` does; `scratch` is a
    folder for what is made. Raises BenchError for unknown names and what the backend declines.
    """
    one, other = find("models", model), find("backends", backend)
    tell(f"reading {data}")
    material = load_material(data, None)
    key = run_key(one, other, material, 0)
    record = ResultFolder(results).find_run(key)
    if record is not None and record.status == "ok":
        path = results / "artifacts" / f"{record.digest()}-0.onnx"
        found = Artifact(path, record.precision, other.load().opener)  # type: ignore[arg-type]
        return _chosen(found, model, backend, material)
    tell(f"fitting {model}")
    fitted = fit_fold(one, material, 0, 0)
    made = other.make()
    if reason := made.supports(fitted):
        raise BenchError(f"{backend} does not take {model}: {reason}")
    tell(f"building {backend}")
    train = material.split.folds[0].train
    X = rows_for(material, fitted.reads)
    rows = TrainingData(X[train], material.errors_m[train], 0)
    return _chosen(made.build(fitted, rows, scratch / "model.onnx"), model, backend, material)


def _chosen(artifact: Artifact, model: str, backend: str, material: Material) -> Chosen:
    fold = material.split.folds[0]
    rows = np.sort(np.concatenate([fold.test_nlos, fold.test_los]))
    X = rows_for(material, [one.name for one in graph_inputs(load_graph(artifact.path))])
    spread = np.linspace(0, len(rows) - 1, min(len(rows), MOST_ROWS)).astype(int)
    simulated = bool(material.recordings.simulated)
    cirs = np.ascontiguousarray(X[rows[spread]])
    return Chosen(artifact, model, backend, material.name, simulated, cirs)
