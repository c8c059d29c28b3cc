"""Reading and writing regular files of sane size, so that a killed process leaves no half one.

Writing goes through a scratch file beside the target that is locked as long as its writer lives;
one without a lock is a leftover of a killed process, and removed by the next that writes there.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from secrets import token_hex
from typing import Any

from bench.errors import BenchError, WriteError

try:
    import fcntl
except ImportError:  # pragma: no cover - systems without it keep leftovers, nothing worse
    fcntl = None  # type: ignore[assignment]

MAX_TEXT_BYTES = 64_000_000  # a record with raw samples takes well under one megabyte
_PART = re.compile(r"^\..*\.[0-9a-f]{12}\.part(\.|$)", re.DOTALL)


@contextmanager
def atomic_path(target: Path) -> Iterator[Path]:
    """Yield a temporary path beside `target`; it replaces `target` only if the block succeeds.

    A link is written through where it leads to a regular file. Raises WriteError where the folder
    cannot be written, the disk is full, or `target` is anything but a regular file.
    """
    scratch, lock = None, None
    try:
        final = _regular_target(target)
        final.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(final.parent)
        scratch, lock = _locked_scratch(final)
        yield scratch
        scratch.replace(final)
    except (OSError, ValueError) as problem:
        said = problem.strerror if isinstance(problem, OSError) else None
        raise WriteError(f"cannot write {target}: {said or problem}") from problem
    finally:
        if scratch is not None:
            scratch.unlink(missing_ok=True)
        if lock is not None:
            os.close(lock)


def write_atomically(target: Path, content: str | bytes) -> None:
    """Write `content` to `target` in one step. Raises WriteError like `atomic_path`."""
    with atomic_path(target) as scratch:
        scratch.write_bytes(content.encode() if isinstance(content, str) else content)


def check_output(target: Path) -> None:
    """Raise WriteError, before any work is done, where `target` could never be written."""
    try:
        _check_folder(_regular_target(target).parent)
    except (OSError, ValueError) as problem:
        said = problem.strerror if isinstance(problem, OSError) else None
        raise WriteError(f"cannot write {target}: {said or problem}") from problem


def _check_folder(folder: Path) -> None:
    """Raise ValueError where a folder is none, or no file can be made in it."""
    place = folder
    while not os.path.lexists(place) and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise ValueError(f"{place} is a file, expected a folder")
    if not os.access(place, os.W_OK | os.X_OK):
        raise ValueError(f"{place} is read-only")
    try_folder(place, folder)


def try_folder(place: Path, folder: Path) -> None:
    """Raise ValueError where nothing can be made in `place`, the nearest there is of `folder`.

    It is tried: what permissions promise, a file system such as /proc need not keep.
    """
    trial = place / f".trial.{token_hex(6)}.part"
    try:
        trial.mkdir()
        trial.rmdir()
    except OSError as problem:
        done = "written" if place == folder else "created"
        raise ValueError(f"folder {folder} cannot be {done}: {problem.strerror}") from problem


def _regular_target(target: Path) -> Path:
    """Return where `target` leads. Raises WriteError unless that is, or can be, a regular file."""
    if target.is_symlink():
        try:
            mode = target.stat().st_mode
        except OSError as problem:
            raise WriteError(
                f"cannot write {target}: a link that leads to no file; expected a regular file"
            ) from problem
        final = Path(os.path.realpath(target))
    elif target.exists():
        mode, final = target.stat().st_mode, target
    else:
        return target
    if not stat.S_ISREG(mode):
        raise WriteError(f"cannot write {target}: {_kind(mode)}; expected a regular file")
    return final


def _locked_scratch(target: Path) -> tuple[Path, int]:
    """Return a new file beside `target` and the descriptor that holds its lock."""
    while True:
        # Not tempfile.mkstemp: its files are readable by this user alone, whatever the umask.
        scratch = target.with_name(f".{target.name[:40]}.{token_hex(6)}.part{target.suffix}")
        lock = os.open(scratch, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
        if _try_lock(lock) and os.fstat(lock).st_nlink:
            return scratch, lock
        os.close(lock)  # taken for a leftover between its making and its lock: another one


def _try_lock(descriptor: int) -> bool:
    if fcntl is None:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True


def remove_leftovers(folder: Path) -> None:
    """Remove what killed processes left half-written in a folder; once per process and folder."""
    _remove_leftovers(os.path.realpath(folder))


@cache
def _remove_leftovers(folder: str) -> None:
    with suppress(OSError):
        names = [entry.name for entry in os.scandir(folder) if _PART.match(entry.name)]
        for path in (Path(folder, name) for name in names):
            _remove_unlocked(path)


def _remove_unlocked(path: Path) -> None:
    if fcntl is None:
        return
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDWR | os.O_NONBLOCK | os.O_NOFOLLOW)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()
        finally:
            os.close(descriptor)


@contextmanager
def in_turn(target: Path) -> Iterator[None]:
    """Wait until no other process is in such a block for the same file, then hold it.

    Where the folder cannot be written, or nothing can be locked, nobody waits.
    """
    own = sha256(target.name.encode()).hexdigest()[:12]
    turn = target.with_name(f".{target.name[:40]}.{own}.part")
    descriptor = None
    with suppress(OSError):
        target.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(turn, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        if fcntl is not None:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
    try:
        yield
    finally:
        if descriptor is not None:
            turn.unlink(missing_ok=True)
            os.close(descriptor)


def read_bytes(path: Path, most: int = MAX_TEXT_BYTES) -> bytes:
    """Return a regular file's content. Raises BenchError for anything else, or a larger one.

    A pipe, a device or a link to one is refused before a byte of it is read.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
        with os.fdopen(descriptor, "rb") as stream:
            found = os.fstat(stream.fileno())
            if not stat.S_ISREG(found.st_mode):
                raise BenchError(f"{path}: {_kind(found.st_mode)}; expected a regular file")
            if found.st_size > most:
                raise BenchError(f"{path}: larger than {most} bytes")
            return stream.read(most + 1)[:most]
    except (OSError, ValueError) as problem:
        said = problem.strerror if isinstance(problem, OSError) else None
        raise BenchError(f"cannot read {path}: {said or problem}") from problem


def read_text(path: Path, most: int = MAX_TEXT_BYTES) -> str:
    """Return a regular file's UTF-8 text. Raises BenchError like `read_bytes`."""
    try:
        return read_bytes(path, most).decode()
    except UnicodeDecodeError as problem:
        raise BenchError(f"cannot read {path}: not UTF-8 text ({problem.reason})") from problem


def read_json(path: Path, most: int = MAX_TEXT_BYTES) -> Any:
    """Return what a JSON file holds. Raises BenchError where it is no such file."""
    import json

    try:
        return json.loads(read_bytes(path, most))
    except (ValueError, RecursionError) as problem:
        raise BenchError(f"{path}: not JSON: {problem}") from problem


def is_regular(path: Path) -> bool:
    """Return True for a regular file, or a link that leads to one."""
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError):
        return False


def _kind(mode: int) -> str:
    """Return what is there instead of a regular file, in words."""
    kinds = {
        stat.S_IFDIR: "a folder",
        stat.S_IFIFO: "a named pipe",
        stat.S_IFSOCK: "a socket",
        stat.S_IFCHR: "a device",
        stat.S_IFBLK: "a device",
    }
    return kinds.get(stat.S_IFMT(mode), "no file")


def cache_dir() -> Path:
    """Return the cache folder: $BENCH_CACHE, else $XDG_CACHE_HOME/uwb-bench, else ~/.cache."""
    if named := os.environ.get("BENCH_CACHE"):
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "uwb-bench"


PICTURES = (".png", ".svg", ".pdf")


def check_picture_name(path: Path) -> None:
    """Raise BenchError where a picture's name ends in none of the kinds that are drawn."""
    if path.suffix not in PICTURES:
        raise BenchError(f"{path}: expected a name that ends in {', '.join(PICTURES)}")
