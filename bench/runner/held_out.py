"""Held-out rows kept when a run ends, so that an export is checked without reading recordings."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.files import cache_dir
from bench.provenance import json_digest, packages_code_hash
from bench.runner.kept_arrays import read_arrays, write_arrays
from bench.runner.keys import Head, head_of
from zoo.inputs import blocks_of

if TYPE_CHECKING:
    from bench.runner.material import Material

Floats = NDArray[np.float32]
MOST_ROWS = 4096
_CODE = (
    *("bench/recordings/window.py", "bench/recordings/splits.py", "bench/recordings/combine.py"),
    *("bench/recordings/draws.py", "bench/runner/material.py", "bench/runner/inputs.py"),
    *("bench/runner/held_out.py", "zoo/inputs.py"),
)


def held_out(material: Material, reads: Collection[str]) -> Floats:
    """Return test rows of the first fold [n, width], evenly spaced, MOST_ROWS at most."""
    from bench.runner.inputs import rows_for

    fold = material.split.folds[0]
    rows = np.sort(np.concatenate([fold.test_nlos, fold.test_los]))
    spread = np.linspace(0, len(rows) - 1, min(len(rows), MOST_ROWS)).astype(int)
    return np.ascontiguousarray(rows_for(material, reads)[rows[spread]])


def keep_held_out(material: Material, reads: Collection[str], again: bool = False) -> None:
    """Keep a material's held-out rows in the cache, where it can be written.

    A file that is there is taken to be good, unless they are to be kept `again`.
    """
    key = _key(head_of(material), reads)
    path = _place(key)
    if path.exists() and not again:
        return
    with suppress(BenchError):
        write_arrays(path, key, {"rows": held_out(material, reads)})


def kept_held_out(head: Head, reads: Collection[str]) -> Floats | None:
    """Return the rows that `held_out` gave for these recordings; None where none are kept."""
    key = _key(head, reads)
    found = read_arrays(_place(key), key)
    return None if found is None else found["rows"]


def _key(head: Head, reads: Collection[str]) -> dict[str, Any]:
    return {
        "data": [head.name, head.fingerprint, head.split],
        "reads": list(blocks_of(reads)),
        "code": packages_code_hash(*_CODE),
    }


def _place(key: dict[str, Any]) -> Path:
    return cache_dir() / "held-out" / f"{json_digest(key, 24)}.npz"
