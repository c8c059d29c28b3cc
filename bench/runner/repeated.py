"""A run of which everything is there already: found without reading or importing anything large.

The first run keeps what the recordings of a file were found to be, with the file's size and time
of change; a later one reads the file only where these differ.
"""

from __future__ import annotations

import os
import time
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.errors import BenchError
from bench.parallel import VARIABLE
from bench.provenance import decisive_versions, keep, kept, packages_code_hash
from bench.runner.keys import Head, run_key
from bench.runner.plan import Plan

if TYPE_CHECKING:
    from bench.results import RunRecord
    from bench.runner.folder import ResultFolder

_KIND = "recordings"
_SETTLED_S = 2.0  # a file changed again within the clock's step would look the same


def question_of(data: Any, split: str | None) -> list[Any] | None:
    """Return all that decides recordings and their split; None where they are not one file."""
    path = None if os.environ.get(VARIABLE) else _file_of(data)  # torch is then asked for threads
    try:
        seen = None if path is None else path.stat()
    except OSError:
        return None
    if path is None or seen is None:
        return None
    identity = [str(path.absolute()), seen.st_size, seen.st_mtime_ns, seen.st_ino]
    code = packages_code_hash("bench/recordings", "bench/physics", "bench/runner/material.py")
    return [str(data), split, identity, code, decisive_versions()]


def remember(question: list[Any] | None, data: Any, split: str | None, head: Head) -> None:
    """Keep what was read, unless the file has changed since `question` or just before it."""
    if question is None or question != question_of(data, split):
        return
    if time.time_ns() - question[2][2] > _SETTLED_S * 1e9:
        keep(_KIND, question, [head.name, head.fingerprint, head.split, head.simulated])


def recalled(question: list[Any] | None) -> Head | None:
    """Return what these recordings were found to be before, None where that is not known."""
    found = None if question is None else kept(_KIND, question)
    return None if found is None else Head(*found)


def finished_runs(plan: Plan, head: Head, folder: ResultFolder) -> list[RunRecord] | None:
    """Return every run of a plan in order where all are finished, else None."""
    runs = []
    for model, seed, backend in product(plan.models, plan.seeds, plan.backends):
        try:
            run = folder.find_run(run_key(model, backend, head, seed))
        except BenchError:  # the run itself says why
            return None
        if run is None:
            return None
        runs.append(run)
    return runs


def _file_of(data: Any) -> Path | None:
    """Return the one file that recordings are read from, None where it is not one."""
    from bench.recordings.sources.base import is_path, open_source

    if not isinstance(data, str | Path):
        return None
    if is_path(data):
        return Path(data)
    try:
        return open_source(str(data)).kept()
    except BenchError:
        return None
