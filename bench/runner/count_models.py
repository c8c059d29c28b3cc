"""`bench count` as a Python call: models and backends on parts, counted row by row."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError, foreign
from bench.measure.counting.compile import Which
from bench.measure.profile import Profile
from bench.plugins import Plugin
from bench.results import Cost, RunRecord
from bench.runner.counting import ROWS, Counted, Floats, count_artifact, recorded_rows
from bench.runner.finished import artifact_of, check_width, finished_runs, inputs_of, newest
from bench.runner.fits import fit_fold
from bench.runner.inputs import missing, rows_for
from bench.runner.material import Material, load_material
from bench.runner.observer import Observer
from bench.runner.parts import countable
from bench.runner.plan import resolve
from bench.runner.records import cost_record

if TYPE_CHECKING:
    from backends.base import Artifact
    from zoo.base import MitigationModel


@dataclass(frozen=True)
class CountRow:
    """One model on one backend and part: counted, or the reason why not.

    `cost` is what an estimate of the same artifact is made from; `data` names the recordings,
    marked where they are SIMULATED.
    """

    model: str
    backend: str
    device: str
    counted: Counted | None
    reason: str | None = None
    precision: str | None = None
    cost: Cost | None = None
    data: str = ""


@dataclass(frozen=True)
class TrainingInputs:
    """The training rows [n, width] as a model takes them, and their errors [n] in metres."""

    rows: Floats
    errors_m: Floats


@dataclass(frozen=True)
class CountPlan:
    """What is to be counted, resolved and checked before anything is fitted."""

    models: tuple[Plugin, ...]
    backends: tuple[Plugin, ...]
    profiles: tuple[Profile, ...]
    which: Which
    rows: int


def make_count_plan(
    model: str, backend: str, device: str, which: Which = "auto", rows: int = ROWS
) -> CountPlan:
    """Resolve names and check the tools.

    `device` may name profile files (.toml) beside the built-in parts; "all" takes every part that
    has a core. Raises BenchError for unknown names, parts without a core and missing tools.
    """
    if rows < 1:
        raise BenchError(f"--rows {rows}: expected a whole number of at least 1")
    profiles = countable(device, which)
    return CountPlan(resolve("models", model), resolve("backends", backend), profiles, which, rows)


def count_models(
    plan: CountPlan, data: str = "rooms", split: str | None = None, watch: Observer | None = None
) -> Iterator[CountRow]:
    """Fit (or take from the cache) each model on the first fold, build, count on every part.

    Yields a row per model, backend and part. Raises BenchError on bad input.
    """
    watch = watch or Observer()
    watch.stage("reading the recordings")
    material = load_material(data, split)
    for row in _fitted(plan, material, watch):
        yield replace(row, data=_named(data, material))


def _named(data: str, material: Material) -> str:
    return f"{data} (SIMULATED)" if material.recordings.simulated else data


def _fitted(plan: CountPlan, material: Material, watch: Observer) -> Iterator[CountRow]:
    for model in plan.models:
        if reason := missing(material, model.load()):
            yield from _all(plan, model.name, reason)
            continue
        tell = partial(watch.progress, f"fitting {model.name}")
        tell(0.0)
        fitted = fit_fold(model, material, 0, 0, tell)
        for backend in plan.backends:
            watch.stage(f"counting {model.name} on {backend.name}")
            yield from _rows(plan, material, fitted, model.name, backend)


def count_finished(
    plan: CountPlan,
    results: Path,
    data: str = "rooms",
    split: str | None = None,
    watch: Observer | None = None,
) -> Iterator[CountRow]:
    """Count the files of finished runs under `results` on every part; nothing is fitted.

    The newest run of each model and backend on these recordings and split is taken. Yields a row
    per model, backend and part. Raises BenchError on bad input.
    """
    watch = watch or Observer()
    watch.stage("reading the recordings")
    runs, material = finished_runs(results, watch.note), load_material(data, split)
    for model in plan.models:
        for backend in plan.backends:
            watch.stage(f"counting {model.name} on {backend.name}")
            one = replace(plan, models=(model,), backends=(backend,))
            for row in _from_files(one, runs, results, material):
                shown = _named(data, material)
                yield replace(row, model=model.name, backend=backend.name, data=shown)


def _from_files(
    plan: CountPlan, runs: list[RunRecord], results: Path, material: Material
) -> Iterator[CountRow]:
    """Yield one model and backend on every part."""
    [model], [backend] = plan.models, plan.backends
    try:
        found = newest(runs, model.name, backend.name, material)
        artifact = artifact_of(found, results)
        rows = recorded_rows(*_test_rows(material, artifact), plan.rows)
    except BenchError as problem:
        yield from _all(plan, model.name, str(problem))
        return
    yield from _counted(plan, artifact, rows)


def _test_rows(material: Material, artifact: Artifact) -> tuple[Floats, NDArray[np.intp]]:
    """Return the inputs [n, width] that a file reads, and the positions of its test rows."""
    fold, inputs = material.split.folds[0], inputs_of(artifact)
    rows = rows_for(material, [one.name for one in inputs])
    check_width(artifact, inputs, rows.shape[1])
    return rows, np.concatenate([fold.test_nlos, fold.test_los])


def _all(plan: CountPlan, model: str, reason: str) -> Iterator[CountRow]:
    """Yield the same reason for every backend and part."""
    for backend in plan.backends:
        for profile in plan.profiles:
            yield CountRow(model, backend.name, profile.name, None, reason)


def _rows(
    plan: CountPlan, material: Material, fitted: MitigationModel, model: str, backend: Plugin
) -> Iterator[CountRow]:
    inputs, fold = rows_for(material, fitted.reads), material.split.folds[0]
    data = TrainingInputs(inputs[fold.train], material.errors_m[fold.train])
    test = np.concatenate([fold.test_nlos, fold.test_los])
    with tempfile.TemporaryDirectory(prefix="uwb-count-") as folder:
        try:
            artifact = _build(backend, fitted, data, Path(folder) / "model.onnx")
        except BenchError as problem:
            for profile in plan.profiles:
                yield CountRow(model, backend.name, profile.name, None, str(problem))
            return
        rows = recorded_rows(inputs, test, plan.rows)
        for row in _counted(plan, artifact, rows):
            yield replace(row, model=model, backend=backend.name)


def _counted(plan: CountPlan, artifact: Artifact, rows: Floats) -> Iterator[CountRow]:
    """Yield a row per part, its names left empty; parts with the same core are counted once."""
    try:
        cost = _cost(artifact)
    except BenchError as problem:
        for profile in plan.profiles:
            yield CountRow("", "", profile.name, None, str(problem))
        return
    by_core: dict[str, list[Profile]] = {}
    for profile in plan.profiles:
        by_core.setdefault(profile.core, []).append(profile)
    for profiles in by_core.values():
        found: list[Counted] | list[None]
        try:
            found, reason = count_artifact(artifact, profiles, rows, plan.which), None
        except BenchError as problem:
            found, reason = [None] * len(profiles), str(problem)
        for profile, one in zip(profiles, found, strict=True):
            yield CountRow("", "", profile.name, one, reason, artifact.precision, cost)


def _cost(artifact: Artifact) -> Cost:
    """Return what an estimate is made from. Raises BenchError for a file that cannot be run.

    What is hostile is refused before the runtime sees it.
    """
    from backends.c.reading import check, load_checked
    from backends.cost import graph_cost

    with foreign("its file cannot be run"):
        check(load_checked(artifact.path))
        return cost_record(graph_cost(artifact.path))


def _build(
    backend: Plugin, fitted: MitigationModel, inputs: TrainingInputs, path: Path
) -> Artifact:
    """Return the artifact. Raises BenchError where the backend declines the model."""
    from backends.base import TrainingData

    adapter = backend.make()
    if reason := adapter.supports(fitted):
        raise BenchError(reason)
    data = TrainingData(inputs.rows, inputs.errors_m, 0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # exporters warn of their own internals
        try:
            artifact: Artifact = adapter.build(fitted, data, path)
        except (ValueError, RuntimeError) as problem:
            raise BenchError(str(problem).splitlines()[0]) from problem
    return artifact
