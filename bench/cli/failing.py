"""How a command ends: the one place that turns every failure into one line and an exit code."""

from __future__ import annotations

import errno
import os
import select
import sys
import traceback as tracebacks
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import click

from bench.cli.console import say
from bench.errors import BenchError
from bench.text import one_line, plain, reason

BAD, INTERRUPTED, NO_READER = 2, 130, 141
STOPPED = (
    "bench: interrupted; what was finished is kept, and the same command goes on from there "
    "(bench diagnose: with -o)"
)
_SHOW = "; --traceback shows where"


def open_streams() -> None:
    """Make both streams take any text, and stand in for a closed one: nothing is written then."""
    for name in ("stdout", "stderr"):
        stream: Any = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def ended_with(work: Callable[[], Any], traceback: bool = False) -> int:
    """Do the work and return the exit code: 0, what it returns, or 2 after one line on stderr.

    130 after an interrupt, 141 where nobody reads the output any more. `traceback` shows where a
    failure came from, above its line.
    """
    try:
        code = work()
        sys.stdout.flush()
    except BaseException as problem:
        return _failed(problem, traceback)
    return code if isinstance(code, int) else 0


def _failed(problem: BaseException, traceback: bool) -> int:
    if _unwrapped() and isinstance(problem, SystemExit) and not _is_read():
        problem = BrokenPipeError()  # click wraps the streams and exits with 1 where nobody reads
    if _is_output(problem):
        _drop_output()
        if isinstance(problem, BrokenPipeError):
            return NO_READER
    if traceback:
        _tell(plain("".join(tracebacks.format_exception(problem))))
    if isinstance(problem, KeyboardInterrupt | click.Abort):
        _tell(STOPPED)
        return INTERRUPTED
    if isinstance(problem, click.exceptions.NoArgsIsHelpError):
        problem.show()
    else:
        _tell(f"bench: {_line(problem)}")
    return BAD


def _line(problem: BaseException) -> str:
    """Return what went wrong, where, and what was expected, as far as the exception tells."""
    if isinstance(problem, BenchError):
        return one_line(str(problem))
    if isinstance(problem, click.ClickException):
        context = getattr(problem, "ctx", None)
        hint = f" (see {context.command_path} --help)" if context else ""
        return one_line(problem.format_message()) + hint
    if isinstance(problem, OSError):
        return _of_system(problem)
    if isinstance(problem, MemoryError):
        return f"not enough memory for this{_SHOW}"
    return f"failed unexpectedly: {reason(problem)}{_SHOW}"


def _of_system(problem: OSError) -> str:
    where = problem.filename if problem.filename is not None else ""
    if _is_output(problem):
        where = "standard output"
    said = problem.strerror or reason(problem)
    return one_line(f"{where}: {said}{_SHOW}" if where else f"{said}{_SHOW}")


def _is_output(problem: BaseException) -> bool:
    """Return True where standard output cannot be written: a full disk, or nobody reads."""
    if isinstance(problem, BrokenPipeError):
        return True
    full = (errno.ENOSPC, errno.EIO, errno.EBADF, errno.EFBIG, errno.EDQUOT)
    return isinstance(problem, OSError) and problem.errno in full and problem.filename is None


def _unwrapped() -> bool:
    """Take off what click has wrapped the streams in, and return True where it had.

    Its class is not public; left on, the next command of this process would seem given up.
    """
    wrapped = type(sys.stdout).__name__.endswith("PacifyFlushWrapper")
    for name in ("stdout", "stderr") if wrapped else ():
        setattr(sys, name, getattr(getattr(sys, name), "wrapped", getattr(sys, name)))
    return wrapped


def _is_read() -> bool:
    """Return False where standard output is a pipe that nobody reads: click means any pipe."""
    try:
        watched = select.poll()
        watched.register(sys.stdout.fileno(), 0)
        return not any(event & select.POLLERR for _, event in watched.poll(0))
    except (OSError, ValueError, AttributeError):  # no file, or a system without
        return False


def _drop_output() -> None:
    """Let what is still to be written go nowhere, or Python fails once more as it ends."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _tell(text: str) -> None:
    with suppress(OSError, ValueError):  # nobody reads that either
        say(text, err=True)
