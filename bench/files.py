"""Writing files so that a killed process never leaves half of one."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

from bench.errors import WriteError


@contextmanager
def atomic_path(target: Path) -> Iterator[Path]:
    """Yield a temporary path beside `target`; it replaces `target` only if the block succeeds.

    Raises WriteError where the folder cannot be written or the disk is full.
    """
    scratch: Path | None = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        # Not tempfile.mkstemp: its files are readable by this user alone, whatever the umask.
        name = f".{target.name[:40]}.{token_hex(6)}.part{target.suffix}"
        scratch = target.with_name(name)
        scratch.touch(exist_ok=False)
        yield scratch
        scratch.replace(target)
    except OSError as problem:
        raise WriteError(f"cannot write {target}: {problem.strerror or problem}") from problem
    finally:
        if scratch is not None:
            scratch.unlink(missing_ok=True)


def write_atomically(target: Path, content: str | bytes) -> None:
    """Write `content` to `target` in one step. Raises WriteError like `atomic_path`."""
    with atomic_path(target) as scratch:
        scratch.write_bytes(content.encode() if isinstance(content, str) else content)


def cache_dir() -> Path:
    """Return the cache folder: $BENCH_CACHE, else $XDG_CACHE_HOME/uwb-bench, else ~/.cache."""
    if named := os.environ.get("BENCH_CACHE"):
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "uwb-bench"
