"""How a fitted model runs: fp32, graph-optimised, fp16, int8 and qat behind one adapter.

Names are imported on first use, so that `import backends` stays free of torch and onnxruntime.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

SCRATCH = "BENCH_SCRATCH"
"""Environment variable: a private folder in which the processes of one run share what they made."""

_HOMES = {
    "Artifact": "backends.base",
    "Backend": "backends.base",
    "KernelCoverage": "backends.base",
    "TrainingData": "backends.base",
}
__all__ = sorted([*_HOMES, "SCRATCH"])


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'backends' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
