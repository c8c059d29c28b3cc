"""The errors a user sees as one clear line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches

from bench.text import reason


class BenchError(Exception):
    """Bad input: what is wrong, where, and what was expected. Exit code 2, no traceback."""


class WriteError(BenchError):
    """The disk is full or the folder read-only: nothing that follows could be kept either."""


@contextmanager
def foreign(what: str) -> Iterator[None]:
    """Run code of a plug-in: whatever it raises, or an attempt to end, becomes a BenchError.

    `what` says what failed. Our own errors and the user's interrupt come through.
    """
    try:
        yield
    except (BenchError, KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException as problem:
        raise BenchError(f"{what}: {reason(problem)}") from problem


@contextmanager
def about(source: str) -> Iterator[None]:
    """Name the table first in whatever BenchError the block raises."""
    try:
        yield
    except BenchError as problem:
        raise type(problem)(f"{source}: {problem}") from problem


def unknown_name(kind: str, name: str, known: Iterable[str]) -> BenchError:
    """Return the error for a name that is not registered, with a did-you-mean."""
    names = sorted(known)
    close = get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    return BenchError(f"unknown {kind} {name!r}{hint} (known: {', '.join(names) or 'none'})")
