"""One benchmark run from names to records: plan, fit, build, score, time, write."""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {"run": "bench.runner.api", "RunSet": "bench.runner.api"}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'bench.runner' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
