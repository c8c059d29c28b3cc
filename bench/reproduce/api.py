"""Running experiments, each kept as one JSON file and reused while nothing has changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

from bench.errors import BenchError, WriteError
from bench.measure.machine import describe_machine
from bench.parallel import obey
from bench.provenance import decisive_versions, json_digest, packages_code_hash
from bench.reproduce.catalogue import Experiment
from bench.reproduce.context import Context
from bench.reproduce.outcome import read_key, read_longest_s, write_outcome
from bench.runner.records import now_utc

PACKAGES = (
    *("zoo", "backends", "bench/measure", "bench/physics", "bench/positioning"),
    *("bench/recordings", "bench/reproduce", "bench/runner"),
)
DECISIVE = ("zoo", "backends", "reports", *PACKAGES)


@dataclass(frozen=True)
class Reproduction:
    """What was done: the outcome files in the order asked, and what could not be done and why."""

    folder: Path
    files: Sequence[Path]
    impossible: Sequence[tuple[str, str]]


def reproduce(experiments: Sequence[Experiment], context: Context) -> Reproduction:
    """Do every experiment that is not done yet and return the files.

    One that these recordings do not allow (no rooms, no CIR) does not stop the others. Raises
    BenchError on bad input before anything is written, and where no experiment was possible.
    """
    obey()
    context.results.check_writable()
    _ = context.recordings
    files, impossible = [], []
    for number, experiment in enumerate(experiments):
        context.watch.runs(number, len(experiments))
        try:
            files.append(_one(experiment, context))
        except WriteError:
            raise
        except BenchError as reason:
            impossible.append((experiment.name, str(reason)))
            context.watch.note(f"{experiment.name} is not possible here: {reason}")
    if not files:
        raise BenchError("; ".join(reason for _, reason in impossible[:1]))
    return Reproduction(context.folder, files, impossible)


def _one(experiment: Experiment, context: Context) -> Path:
    """Return the file of one experiment, done now unless it was before."""
    path = context.folder / f"{experiment.name}.json"
    key = _key(experiment, context)
    if read_key(path, context.watch.note) == key:
        return path
    context.watch.stage(experiment.name)
    start = perf_counter()
    outcome = experiment.load()(context)
    elapsed_s = round(perf_counter() - start, 1)
    done = replace(
        outcome,
        elapsed_s=elapsed_s,
        longest_s=max(elapsed_s, read_longest_s(path, outcome)),
        host=describe_machine(),
        created_utc=now_utc(),
        key=key,
    )
    write_outcome(done, path)
    return path


def _key(experiment: Experiment, context: Context) -> str:
    """Return 20 hex digits of all that determines an outcome."""
    content = {
        "experiment": experiment.name,
        "data": context.recordings.fingerprint,
        "simulated": context.recordings.simulated,
        "name": context.name,
        "split": context.split,
        "quick": context.quick,
        "device": context.device if experiment.for_device else "",
        "code": packages_code_hash(*PACKAGES),
        "versions": decisive_versions(),
    }
    return json_digest(content)
