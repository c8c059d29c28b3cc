"""How many blocks are simulated at once."""

from __future__ import annotations

import os


def workers() -> int:
    """Return the number of CPUs this process may use, at most 16."""
    if hasattr(os, "sched_getaffinity"):
        return min(16, len(os.sched_getaffinity(0)))
    return min(16, os.cpu_count() or 1)
