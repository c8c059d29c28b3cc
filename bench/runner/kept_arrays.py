"""Arrays kept in a file with what they depend on; read back only where that is the same.

Fits, and the rows that exports are checked on.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import BenchError
from bench.files import atomic_path, read_bytes

MOST_BYTES = 2_000_000_000
_KEY, _SUM = "bench.key", "bench.sha256"


def write_arrays(path: Path, key: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
    """Keep arrays by name. Raises BenchError where the file cannot be written."""
    seals = {_KEY: json.dumps(key, sort_keys=True), _SUM: _sum(arrays)}
    with atomic_path(path) as scratch, scratch.open("wb") as stream:
        np.savez(stream, **arrays, **seals)  # type: ignore[arg-type]


def read_arrays(path: Path, key: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the arrays kept under this key; None where there are none that can be believed."""
    try:
        with np.load(io.BytesIO(read_bytes(path, MOST_BYTES)), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (BenchError, ValueError, EOFError, zipfile.BadZipFile, zlib.error, NotImplementedError):
        return None
    believed = str(arrays.pop(_KEY, "")) == json.dumps(key, sort_keys=True)
    return arrays if believed and str(arrays.pop(_SUM, "")) == _sum(arrays) else None


def _sum(arrays: Mapping[str, Any]) -> str:
    """Return the hash of every array with its name, shape and type."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        value = np.ascontiguousarray(arrays[name])
        digest.update(f"{name}{value.shape}{value.dtype.str}".encode() + value.tobytes())
    return digest.hexdigest()
