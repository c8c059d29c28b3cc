"""Timing the artifacts of finished runs, all together, after everything else has ended."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from bench.errors import BenchError
from bench.measure.energy import host_meter
from bench.measure.latency import Timing, TimingTarget, measure
from bench.measure.machine import describe_machine
from bench.plugins import find
from bench.results import RunRecord, TimingRecord
from bench.runner.failure import Failure
from bench.runner.folder import ResultFolder
from bench.runner.observer import Observer
from bench.runner.records import now_utc

AT_ONCE = 25  # workers kept alive together: each holds a runtime of about 100 MB


def time_artifacts(
    runs: Sequence[RunRecord], folder: ResultFolder, widths: Mapping[str, int], watch: Observer
) -> tuple[list[TimingRecord], list[Failure]]:
    """Return a timing per model and backend (the first seed's artifact), measured or known.

    `widths`: how many columns a row has, by model.

    Nothing else runs meanwhile. One artifact that cannot be timed does not stop the others.
    """
    machine = describe_machine()
    known: list[TimingRecord] = []
    missing: list[RunRecord] = []
    for run in _first_seeds(runs):
        earlier = folder.find_timing(_untimed(run, machine), watch.note)
        known.append(earlier) if earlier else missing.append(run)
    failures: list[Failure] = []
    for start in range(0, len(missing), AT_ONCE):
        block = missing[start : start + AT_ONCE]
        for run, timing in zip(block, _measure(block, folder, widths, watch), strict=True):
            if isinstance(timing, BenchError):
                failures.append(_failure(run, timing))
            else:
                known.append(_record(run, timing, machine))
                folder.write_timing(known[-1])
    return known, failures


def _measure(
    runs: Sequence[RunRecord], folder: ResultFolder, widths: Mapping[str, int], watch: Observer
) -> list[Timing | BenchError]:
    targets = [
        TimingTarget(
            folder.artifact_path(run.digest(), 0),
            opener_of(run.key.backend),
            widths[run.key.model],
            label=f"{run.key.model} on {run.key.backend}",
        )
        for run in runs
    ]
    return measure(
        targets, progress=partial(watch.progress, "measuring latency"), meter=host_meter()
    )


def opener_of(backend: str) -> str:
    """Return what opens a backend's files: the registered backend says so, no file ever does."""
    return str(find("backends", backend).load().opener)


def _first_seeds(runs: Sequence[RunRecord]) -> list[RunRecord]:
    """Return the lowest seed's finished run of every model and backend."""
    first: dict[tuple[str, str], RunRecord] = {}
    for run in sorted(runs, key=lambda one: one.key.seed):
        if run.status == "ok":
            first.setdefault((run.key.model, run.key.backend), run)
    return list(first.values())


def _untimed(run: RunRecord, machine: dict[str, Any]) -> TimingRecord:
    """Return the record that a timing of the run on this machine will be like."""
    return TimingRecord(
        model=run.key.model,
        backend=run.key.backend,
        data=run.key.data,
        artifact_sha256=str(run.artifact_sha256),
        machine=machine,
        latency=[],
        throughput_rows_per_s=0.0,
        peak_memory_bytes=0,
        energy_mj=None,
        energy_how="",
    )


def _record(run: RunRecord, timing: Timing, machine: dict[str, Any]) -> TimingRecord:
    return replace(
        _untimed(run, machine),
        latency=timing.latency,
        throughput_rows_per_s=timing.throughput_rows_per_s,
        peak_memory_bytes=timing.peak_memory_bytes,
        energy_mj=timing.energy_mj,
        energy_how=timing.energy_how,
        created_utc=now_utc(),
    )


def _failure(run: RunRecord, problem: BenchError) -> Failure:
    return Failure(run.key.model, run.key.backend, run.key.seed, f"timing: {problem}")
