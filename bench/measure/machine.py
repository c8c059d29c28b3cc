"""What this machine is: enough to compare timings, nothing personal."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from bench.measure.cpu import processor

RUNTIME_PACKAGES = ("numpy", "onnxruntime")
"""What a timing runs on besides Python; another version is another machine."""


def describe_machine() -> dict[str, Any]:
    """Return cpu, cores, memory_gib, instruction_sets, system, python, versions and an `id`.

    The id hashes all the others but the memory, which systems round as they like. Host names,
    users and serial numbers are left out on purpose.
    """
    return dict(_described())


@cache
def _described() -> tuple[tuple[str, Any], ...]:
    name, sets = processor()
    facts: dict[str, Any] = {
        "cpu": name,
        "cores": os.cpu_count() or 1,
        "instruction_sets": sets,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {package: _version(package) for package in RUNTIME_PACKAGES},
    }
    digest = hashlib.sha256(repr(sorted(facts.items())).encode()).hexdigest()[:12]
    return tuple({**facts, "memory_gib": _memory_gib(), "id": digest}.items())


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"


def _memory_gib() -> float:
    import psutil

    return round(int(psutil.virtual_memory().total) / 2**30, 1)
