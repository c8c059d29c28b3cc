"""One model and seed: fitted once per fold, run on every backend, each run written when done."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from bench.errors import BenchError, WriteError
from bench.files import atomic_path
from bench.plugins import Plugin
from bench.provenance import file_sha256
from bench.results import RunKey, RunRecord
from bench.runner.evaluate import evaluate
from bench.runner.failure import DeclinedError, Failure, said
from bench.runner.fits import fit_fold
from bench.runner.folder import ResultFolder
from bench.runner.graph_check import graph_remark
from bench.runner.held_out import keep_held_out
from bench.runner.inputs import missing, rows_for
from bench.runner.keys import run_key
from bench.runner.material import Material
from bench.runner.observer import Observer
from bench.runner.plan import Plan
from bench.runner.records import finished_record, skipped_record, write_predictions

if TYPE_CHECKING:
    from backends.base import Backend
    from zoo.base import MitigationModel


@dataclass(frozen=True)
class Job:
    """One run to do."""

    model: Plugin
    backend: Plugin
    key: RunKey


@dataclass(frozen=True)
class Fitted:
    """A model fitted on every fold, and how long the fits took in this process."""

    models: Sequence[MitigationModel]
    fit_s: float


def run_group(
    model: Plugin, seed: int, plan: Plan, material: Material, folder: ResultFolder, watch: Observer
) -> list[RunRecord | Failure]:
    """Run one model and seed on every backend; the fits are shared and made only when needed."""
    outcomes: list[RunRecord | Failure] = []
    fitted: Fitted | BenchError | None = None
    for backend in plan.backends:
        try:
            job = Job(model, backend, run_key(model, backend, material, seed))
        except BenchError as problem:
            outcomes.append(_failure(model, backend, seed, problem, watch))
            continue
        if (known := folder.find_run(job.key, watch.note)) is not None:
            outcomes.append(known)
            continue
        if reason := missing(material, job.model.load()):
            outcomes.append(_skipped(job, reason, folder, watch))
            continue
        fitted = fitted or _fit(job, material, watch)
        outcomes.append(_run_one(job, fitted, material, folder, watch))
    return outcomes


def _fit(job: Job, material: Material, watch: Observer) -> Fitted | BenchError:
    start = perf_counter()
    folds = range(len(material.split.folds))
    try:
        models = []
        for fold in folds:
            what = f"fitting {job.model.name}, seed {job.key.seed}, fold {fold + 1}/{len(folds)}"
            watch.progress(what, 0.0)
            tell = partial(watch.progress, what)
            models.append(fit_fold(job.model, material, fold, job.key.seed, tell))
        fitted = Fitted(models, perf_counter() - start)
        rows = rows_for(material, models[0].reads)[material.split.folds[0].train]
        if remark := graph_remark(job.model.name, models[0], rows):
            watch.note(remark)
        return fitted
    except (WriteError, KeyboardInterrupt):
        raise
    except BaseException as problem:  # a plug-in must not end the harness
        return BenchError(said(problem))


def _run_one(
    job: Job,
    fitted: Fitted | BenchError,
    material: Material,
    folder: ResultFolder,
    watch: Observer,
) -> RunRecord | Failure:
    """Return the record of one run, or its failure as one line."""
    try:
        if isinstance(fitted, BenchError):
            raise fitted
        return _record(job, fitted, material, folder, watch)
    except (WriteError, KeyboardInterrupt):
        raise
    except BaseException as problem:  # a plug-in must not end the harness
        return _failure(job.model, job.backend, job.key.seed, problem, watch)


def _failure(
    model: Plugin, backend: Plugin, seed: int, problem: BaseException, watch: Observer
) -> Failure:
    failure = Failure(model.name, backend.name, seed, said(problem))
    watch.note(str(failure))
    return failure


def _record(
    job: Job, fitted: Fitted, material: Material, folder: ResultFolder, watch: Observer
) -> RunRecord:
    backend = job.backend.make()
    reason = backend.supports(fitted.models[0])
    if reason is not None:
        return _skipped(job, str(reason), folder, watch)
    try:
        record = _evaluate(job, backend, fitted, material, folder, watch)
    except DeclinedError as problem:
        return _skipped(job, str(problem), folder, watch)
    folder.write_run(record)
    return record


def _skipped(job: Job, reason: str, folder: ResultFolder, watch: Observer) -> RunRecord:
    watch.note(f"{job.model.name} on {job.backend.name} skipped: {reason}")
    record = skipped_record(job.key, reason)
    folder.write_run(record)
    return record


def _evaluate(
    job: Job,
    backend: Backend,
    fitted: Fitted,
    material: Material,
    folder: ResultFolder,
    watch: Observer,
) -> RunRecord:
    digest = job.key.digest()
    what = f"{job.model.name} on {job.backend.name}, seed {job.key.seed}"
    watch.progress(what, 0.0)
    with ExitStack() as stack, warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # exporters warn of their own internals
        targets = [folder.artifact_path(digest, fold) for fold in range(len(fitted.models))]
        paths = [stack.enter_context(atomic_path(target)) for target in targets]
        tell = partial(watch.progress, what)
        done = evaluate(fitted.models, backend, material, job.key.seed, paths, tell)
        record = finished_record(job.key, material, done, fitted.models, fitted.fit_s)
        record = replace(record, artifacts_sha256=tuple(map(file_sha256, paths)))
    keep_held_out(material, fitted.models[0].reads)
    predictions = folder.predictions_path(digest)
    write_predictions(predictions, material, done)
    return replace(record, predictions_sha256=file_sha256(predictions))
