"""Timing the artifacts of finished runs, all together, after everything else has ended."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from bench.errors import BenchError
from bench.measure.energy import host_meter
from bench.measure.latency import Timing, TimingTarget, measure
from bench.measure.machine import describe_machine
from bench.measure.quiet import Patience
from bench.plugins import find
from bench.results import RunRecord, TimingRecord
from bench.runner.failure import Failure
from bench.runner.folder import ResultFolder
from bench.runner.observer import Observer
from bench.runner.records import now_utc

WAIT_S = 120.0  # for a quiet machine, in all; BENCH_WAIT_S says another number of seconds
AT_ONCE = 25  # workers kept alive together: each holds a runtime of about 100 MB


def time_artifacts(
    runs: Sequence[RunRecord],
    folder: ResultFolder,
    widths: Mapping[str, int],
    watch: Observer,
    wait: bool = True,
) -> tuple[list[TimingRecord], list[Failure]]:
    """Return a timing per model and backend (the first seed's artifact), measured or known.

    `widths`: how many columns a row has, by model.

    Nothing else of ours runs meanwhile; `wait` waits, bounded, until nobody else's does. One
    artifact that cannot be timed does not stop the others. A timing that the machine was too busy
    for is written without figures, and tried again by the next run.
    """
    machine = describe_machine()
    patience = Patience(wait_s() if wait else 0.0, watch.stage)
    known: list[TimingRecord] = []
    missing: list[RunRecord] = []
    for run in first_seeds(runs):
        earlier = folder.find_timing(_untimed(run, machine), watch.note)
        known.append(earlier) if earlier and not earlier.withheld else missing.append(run)
    failures: list[Failure] = []
    for start in range(0, len(missing), AT_ONCE):
        block = missing[start : start + AT_ONCE]
        for run, timing in zip(
            block, _measure(block, folder, widths, watch, patience), strict=True
        ):
            if isinstance(timing, BenchError):
                failures.append(_failure(run, timing))
            else:
                known.append(_record(run, timing, machine))
                if timing.withheld:
                    watch.note(
                        f"{run.key.model} on {run.key.backend}: no timing: {timing.withheld}"
                    )
                folder.write_timing(known[-1])
    return known, failures


def known_timings(runs: Sequence[RunRecord], folder: ResultFolder) -> list[TimingRecord] | None:
    """Return the timing of every model and backend where all are known, else None."""
    machine = describe_machine()
    found = [folder.find_timing(_untimed(run, machine)) for run in first_seeds(runs)]
    known = [one for one in found if one and not one.withheld]
    return known if len(known) == len(found) else None


def wait_s() -> float:
    """Return how long to wait for a quiet machine, in seconds. Raises BenchError on nonsense."""
    said = os.environ.get("BENCH_WAIT_S", "").strip()
    try:
        found = float(said or WAIT_S)
    except ValueError:
        found = math.nan
    if not 0 <= found < math.inf:
        raise BenchError(f"BENCH_WAIT_S = {said!r}: expected a number of seconds of 0 or more")
    return found


def _measure(
    runs: Sequence[RunRecord],
    folder: ResultFolder,
    widths: Mapping[str, int],
    watch: Observer,
    patience: Patience,
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
        targets,
        progress=partial(watch.progress, "measuring latency"),
        meter=host_meter(),
        patience=patience,
    )


def opener_of(backend: str) -> str:
    """Return what opens a backend's files: the registered backend says so, no file ever does."""
    return str(find("backends", backend).load().opener)


def first_seeds(runs: Sequence[RunRecord]) -> list[RunRecord]:
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
        rounds=timing.rounds,
        dropped=timing.dropped,
        reference_us=timing.reference_us,
        withheld=timing.withheld,
        created_utc=now_utc(),
    )


def _failure(run: RunRecord, problem: BenchError) -> Failure:
    return Failure(run.key.model, run.key.backend, run.key.seed, f"timing: {problem}")
