"""Which source made a page: the commit, where the package lies in a git checkout."""

from __future__ import annotations

import subprocess
from pathlib import Path

import bench
from bench.reproduce.api import PACKAGES

UNKNOWN = "unknown (not a git checkout)"
DECISIVE = ("zoo", "backends", "reports", *PACKAGES)
_PATIENCE_S = 10


def commit() -> str:
    """Return the commit of the source, and whether what decides a page differs from it."""
    folder = Path(bench.__file__).parents[1]
    if not (folder / ".git").exists():
        return UNKNOWN
    name = _git(folder, "rev-parse", "--short=12", "HEAD")
    changed = _git(folder, "status", "--porcelain", "--", *DECISIVE)
    return (name or UNKNOWN) + (" with uncommitted changes" if changed else "")


def _git(folder: Path, *words: str) -> str:
    """Return what git prints, nothing where it cannot be asked."""
    try:
        done = subprocess.run(  # noqa: S603 - fixed command
            ["git", "-C", str(folder), *words],  # noqa: S607 - the user's own git
            capture_output=True,
            text=True,
            timeout=_PATIENCE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip()
