"""Model files that an export built, kept in the cache: the next one needs no training library."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from backends.base import Artifact
from bench.errors import BenchError
from bench.files import cache_dir
from bench.plugins import Plugin, find
from bench.results import RunKey
from bench.runner.kept_arrays import read_arrays, write_arrays


def keep_built(artifact: Artifact, key: RunKey) -> None:
    """Keep an artifact under all that decides it, where the cache can be written."""
    content = np.frombuffer(artifact.path.read_bytes(), np.uint8)
    arrays = {"content": content, "precision": artifact.precision}
    with suppress(BenchError):
        write_arrays(_place(key), _plain(key), arrays)


def builder_of(backend: Plugin) -> Plugin:
    """Return the backend that makes a backend's files: itself, or the one whose files it runs."""
    other = getattr(backend.load(), "exports_as", None)
    return backend if other is None else builder_of(find("backends", other))


def kept_built(key: RunKey, path: Path, opener: str) -> Artifact | None:
    """Write the file that was built for this key to `path`; None where there is none."""
    found = read_arrays(_place(key), _plain(key))
    if found is None:
        return None
    path.write_bytes(found["content"].tobytes())
    return Artifact(path, str(found["precision"]), opener)  # type: ignore[arg-type]


def _place(key: RunKey) -> Path:
    return cache_dir() / "built" / f"{key.digest()}.npz"


def _plain(key: RunKey) -> dict[str, Any]:
    return asdict(key)
