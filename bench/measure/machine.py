"""What this machine is: enough to compare timings, nothing personal."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from pathlib import Path
from typing import Any

INSTRUCTION_SETS = (
    *("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512_vnni", "avx_vnni", "amx_int8"),
    *("asimd", "asimddp", "i8mm"),
)


@cache
def _described() -> tuple[tuple[str, Any], ...]:
    flags = _cpu_flags()
    facts: dict[str, Any] = {
        "cpu": _cpu_model(),
        "cores": os.cpu_count() or 1,
        "instruction_sets": [name for name in INSTRUCTION_SETS if name in flags],
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }
    facts["id"] = hashlib.sha256(repr(sorted(facts.items())).encode()).hexdigest()[:12]
    return tuple(facts.items())


def describe_machine() -> dict[str, Any]:
    """Return cpu, cores, instruction_sets, system, python and an `id` that hashes these.

    Host names, users and serial numbers are left out on purpose.
    """
    return dict(_described())


def _cpu_model() -> str:
    for line in _cpuinfo():
        name, _, value = line.partition(":")
        if name.strip() in ("model name", "Model"):
            return value.strip()
    return platform.processor() or "unknown"


def _cpu_flags() -> set[str]:
    """Return the instruction sets Linux lists; empty on other systems, which do not list them."""
    for line in _cpuinfo():
        name, _, value = line.partition(":")
        if name.strip() in ("flags", "Features"):
            return set(value.split())
    return set()


def _cpuinfo() -> list[str]:
    try:
        return Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return []
