"""uwb-bench: benchmark UWB range-error mitigation, and diagnose what a simulator leaves out.

>>> import bench
>>> runs = bench.run(model="remnet", backend="int8", data="rooms")  # doctest: +SKIP
>>> runs.frame()  # doctest: +SKIP
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"
_HOMES = {
    "BenchError": "bench.errors",
    "Recordings": "bench.recordings",
    "read_recordings": "bench.recordings",
    "run": "bench.runner",
}
__all__ = sorted([*_HOMES, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'bench' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
