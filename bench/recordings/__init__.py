"""Recordings: the exchange table, its readers, windows and splits by link."""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "Recordings": "bench.recordings.table",
    "read_recordings": "bench.recordings.io",
    "write_recordings": "bench.recordings.io",
    "open_recordings": "bench.recordings.open",
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'bench.recordings' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
