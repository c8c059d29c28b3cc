"""Sweeps: many independent points, each kept as soon as it is done, spread as the user likes."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import BenchError
from bench.files import read_json, write_atomically
from bench.parallel import Work
from bench.provenance import (
    decisive_versions,
    is_sealed,
    json_digest,
    packages_code_hash,
    sealed,
)
from bench.reproduce.context import Context

CODE = ("zoo", "bench/measure/metrics.py", "bench/reproduce/raw_mlp.py")


def sweep(context: Context, name: str, work: Work, shared: Any, tasks: Sequence[Any]) -> list[Any]:
    """Return work(shared, task) of every task, in order; those done before are read, not redone.

    `shared` and the tasks are dataclasses of arrays and plain values, all that a point depends on;
    what `work` gives must be JSON. An interrupted sweep keeps the points that were finished.
    """
    basis = _basis(work, shared)
    paths = [context.folder / "points" / f"{name}-{_digest(basis, task)}.json" for task in tasks]
    results = [_read(*pair) for pair in zip(paths, tasks, strict=True)]
    missing = [at for at, found in enumerate(results) if found is None]
    done = len(tasks) - len(missing)
    what = f"{name}: {len(tasks)} points"
    context.watch.progress(what, done / len(tasks))
    for number, result in context.spread.map(work, shared, [tasks[at] for at in missing]):
        at, done = missing[number], done + 1
        point = {"task": asdict(tasks[at]), "result": result}
        write_atomically(paths[at], json.dumps(sealed(json.loads(json.dumps(point)))))
        results[at] = result
        context.watch.progress(what, done / len(tasks))
    return results


def _basis(work: Work, shared: Any) -> str:
    """Return a hash of the data, the code and the libraries that every point rests on.

    Code: the module of `work` and what it calls (`CODE`), so that other edits cost no training.
    """
    digest = hashlib.sha256(f"{work.__module__}.{work.__qualname__}".encode())
    digest.update(packages_code_hash(*CODE).encode())
    digest.update(Path(inspect.getfile(work)).read_bytes())
    digest.update(json_digest(decisive_versions()).encode())
    for field in fields(shared):
        digest.update(field.name.encode() + _bytes(getattr(shared, field.name)))
    return digest.hexdigest()


def _bytes(value: Any) -> bytes:
    if isinstance(value, np.ndarray):
        return repr((value.shape, value.dtype)).encode() + np.ascontiguousarray(value).tobytes()
    if isinstance(value, dict):
        return b"".join(str(key).encode() + _bytes(part) for key, part in value.items())
    if hasattr(value, "__dataclass_fields__"):
        return b"".join(_bytes(getattr(value, field.name)) for field in fields(value))
    return repr(value).encode()


def _digest(basis: str, task: Any) -> str:
    return json_digest([basis, asdict(task)])


def _read(path: Path, task: Any) -> Any:
    """Return a point's result, None where there is none that can be believed."""
    try:
        content = read_json(path)
    except BenchError:
        return None
    believed = is_sealed(content) and content["task"] == json.loads(json.dumps(asdict(task)))
    return content["result"] if believed else None
