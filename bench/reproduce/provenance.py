"""Which source made a page: the commit, where the package lies in a git checkout."""

from __future__ import annotations

import subprocess
from pathlib import Path

import bench

UNKNOWN = "unknown (not a git checkout)"
_PATIENCE_S = 10


def commit() -> str:
    """Return the commit of the source, with "-dirty" where tracked files differ from it."""
    folder = Path(bench.__file__).parents[1]
    if not (folder / ".git").exists():
        return UNKNOWN
    command = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        done = subprocess.run(  # noqa: S603 - fixed command
            command, capture_output=True, text=True, timeout=_PATIENCE_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return UNKNOWN
    return done.stdout.strip() or UNKNOWN
