"""Work beside itself in forked processes, for what threads would wait with for the interpreter.

A fork knows all that this process knows, so nothing is sent to it, and ends with its last piece of
work. What a piece gives depends on the piece alone; whatever a fork fails at is done here.
"""

from __future__ import annotations

import ctypes
import os
import pickle
import select
import signal
import struct
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import Any, NoReturn, TypeVar, cast

from bench.parallel import VARIABLE, threads

T = TypeVar("T")
R = TypeVar("R")
_PLACE = struct.Struct("=I")
_MOST = 4096  # pieces, whose places a pipe takes at once: 16 KiB
_PATIENCE_S, _PATIENCE = 30.0, 10.0
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
_ALLOWED: ContextVar[bool] = ContextVar("forking", default=False)


def in_forks(work: Callable[[T], R], items: Iterable[T]) -> list[R]:
    """Return `work` of every item in order, done by as many forks as there are threads.

    Each takes the next item that nobody took. Only what can be pickled comes back. Where `forking`
    does not allow it, without another thread to use, or elsewhere than on Linux, all is done here.
    Raises what `work` raises.
    """
    items = list(items)
    forks = min(threads(), len(items)) - 1
    if forks < 1 or len(items) > _MOST or not (_ALLOWED.get() and able()):
        return [work(item) for item in items]
    places = _filled(len(items))
    workers = [_Fork.begun(work, items, places) for _ in range(forks)]
    try:
        started = time.monotonic()
        done = dict(_taken(work, items, places))
        patience_s = _PATIENCE_S + _PATIENCE * (time.monotonic() - started)
        for worker in workers:
            done |= worker.result(patience_s)
    finally:
        os.close(places)
        for worker in workers:
            worker.end()
    return [done[at] if at in done else work(item) for at, item in enumerate(items)]


def both(one: Callable[[], T], other: Callable[[], R]) -> tuple[T, R]:
    """Return what two pieces of work give, done beside one another as `in_forks` does."""
    works: list[Callable[[], Any]] = [one, other]
    made = in_forks(lambda work: work(), works)
    return cast("T", made[0]), cast("R", made[1])


@contextmanager
def forking(allowed: bool) -> Iterator[None]:
    """Allow `in_forks` to fork, for work that runs nobody else's code.

    A user's own simulator may hold threads or a graphics card, which no fork can use.
    """
    before = _ALLOWED.set(allowed)
    try:
        yield
    finally:
        _ALLOWED.reset(before)


def able() -> bool:
    """Return whether this process may be forked: on Linux, from its first thread."""
    return sys.platform == "linux" and threading.current_thread() is threading.main_thread()


def _filled(count: int) -> int:
    """Return the reading end of a pipe that holds the places 0 to `count` - 1."""
    reading, writing = os.pipe()
    os.write(writing, b"".join(_PLACE.pack(at) for at in range(count)))
    os.close(writing)
    return reading


def _taken(work: Callable[[T], R], items: Sequence[T], places: int) -> list[tuple[int, R]]:
    """Return (place, result) of every item whose place was left in the pipe."""
    out = []
    while place := os.read(places, _PLACE.size):
        at = _PLACE.unpack(place)[0]
        out.append((at, work(items[at])))
    return out


class _Fork:
    """A forked process and the pipe that its results come through."""

    def __init__(self, process: int, results: int) -> None:
        self._process, self._results = process, results

    @classmethod
    def begun(cls, work: Callable[[T], R], items: Sequence[T], places: int) -> _Fork:
        """Return a fork that takes items."""
        reading, writing = os.pipe()
        parent = os.getpid()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads that a fork has not
            process = os.fork()
        if process == 0:
            _work(work, items, places, writing, parent)
        os.close(writing)
        return cls(process, reading)

    def result(self, patience_s: float) -> dict[int, Any]:
        """Return what it made by place, nothing where it failed or takes longer than that."""
        packed, until = bytearray(), time.monotonic() + patience_s
        while select.select([self._results], [], [], max(until - time.monotonic(), 0))[0]:
            part = os.read(self._results, 1 << 20)
            if not part:
                break
            packed += part
        with suppress(pickle.UnpicklingError, EOFError):
            return cast("dict[int, Any]", pickle.loads(packed))  # noqa: S301 - of our own fork
        return {}

    def end(self) -> None:
        """End the fork, whatever it does."""
        os.close(self._results)
        with suppress(ProcessLookupError):
            os.kill(self._process, signal.SIGKILL)
        with suppress(ChildProcessError):
            os.waitpid(self._process, 0)


def _work(
    work: Callable[[T], R], items: Sequence[T], places: int, results: int, parent: int
) -> NoReturn:
    """Do what is left, write it and end at once: nothing of this process is to be closed twice."""
    try:
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() == parent:
            os.environ[VARIABLE] = "1"
            packed = pickle.dumps(dict(_taken(work, items, places)))
            with os.fdopen(results, "wb") as out:
                out.write(packed)
    finally:
        os._exit(0)
