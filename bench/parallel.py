"""The one rule for threads, processes and Dask.

What a piece of work gives depends on the piece alone (every draw has a key of its own), so results
do not depend on how it was spread. Nothing is timed here: work beside other work cannot be.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from multiprocessing import resource_tracker
from threading import Lock, Thread
from time import sleep
from types import ModuleType
from typing import Any, TypeVar, cast

from bench.errors import BenchError

T = TypeVar("T")
R = TypeVar("R")
MOST = 16
AHEAD = 2
VARIABLE = "BENCH_THREADS"


def threads() -> int:
    """Return how many threads to use: BENCH_THREADS, else the cores this process may use."""
    asked = os.environ.get(VARIABLE, "")
    if asked.isdigit() and int(asked) > 0:
        return int(asked)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(cores or 1, MOST))


def obey() -> None:
    """Have torch use as many threads as `threads` says, where BENCH_THREADS says so.

    Called before anything is trained or keyed; without the variable torch decides for itself.
    """
    if os.environ.get(VARIABLE, ""):
        import torch

        torch.set_num_threads(threads())


def one_openmp_thread() -> AbstractContextManager[Any]:
    """Return a context in which OpenMP, in which scikit-learn's trees grow, uses one thread.

    Trees of a few thousand rows gain nothing from more. On a busy machine the threads wait for one
    another after each of many short steps, ten times as long as the work takes.
    """
    import sklearn.ensemble  # noqa: F401 - only pools that are loaded are limited
    from threadpoolctl import threadpool_limits

    return cast("AbstractContextManager[Any]", threadpool_limits(1, user_api="openmp"))


def one_blas_thread() -> AbstractContextManager[Any]:
    """Return a context in which linear algebra uses one thread: matrices of a diagnosis are small.

    It holds for all threads of this process.
    """
    import scipy.linalg  # noqa: F401 - with a pool of its own, beside numpy's
    from threadpoolctl import threadpool_limits

    return cast("AbstractContextManager[Any]", threadpool_limits(1, user_api="blas"))


def in_threads(work: Callable[[T], R], items: Iterable[T]) -> list[R]:
    """Return `work` of every item in order. The first exception, in order, is raised."""
    count, items = threads(), list(items)
    if count == 1 or len(items) < 2:
        return [work(item) for item in items]
    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(work, items))


def a_few_at_once(work: Callable[[T], R], items: Iterable[T]) -> Generator[R, None, None]:
    """Yield `work` of every item in order, of two at a time where there are threads for it.

    For work that is done in threads of its own for the most part: what is not runs beside the next
    item's. Memory holds three. Close it when done.
    """
    count = min(AHEAD, threads())
    with ThreadPoolExecutor(count) as pool:
        yield from _in_order(lambda item: pool.submit(work, item), items, count)


def _in_order(
    submit: Callable[[T], Future[R]], items: Iterable[T], most: int
) -> Generator[R, None, None]:
    """Yield what submitted items give, in order, with `most` and one more of them under way."""
    coming: deque[Future[R]] = deque()
    for item in items:
        coming.append(submit(item))
        if len(coming) > most:
            yield coming.popleft().result()
    while coming:
        yield coming.popleft().result()


def in_processes(
    work: Work, shared: Any, items: Iterable[Any], jobs: int, forks: bool = False, idle: Any = None
) -> Generator[Any, None, None]:
    """Yield work(shared, item) of every item in order, of some items at a time in `jobs` processes.

    For work that threads would wait with for the interpreter. Nothing that `shared` and the items
    hold may come from the user's script: it is not run again in these processes, so that it needs
    no `if __name__ == "__main__"`. Memory holds 2 `jobs` items. Close it when done. `forks`: they
    begin as forks, at once, before the first item is made; where no thread here may hold what the
    work needs. `idle` is an item that they work on until then, for what the first work costs more.
    Raises BenchError where a process is ended from outside.
    """
    pool, broken = _pool(jobs, shared, "fork" if forks else "spawn"), None

    def submit(item: Any) -> Future[Any]:
        with _starting(), _no_script():
            return pool.submit(_call, work, item)

    try:
        if forks:
            with _starting(), warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of threads a fork has not
                pool.submit(sleep, 0).result()
            for _ in range(0 if idle is None else jobs):
                submit(idle)
        yield from _in_order(submit, items, AHEAD * jobs)
    except BrokenProcessPool as problem:
        broken = problem
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
    if broken is not None:
        sleep(_MOMENT_S)  # an interruption that ended it ends this one, too, and is no fault
        raise BenchError(
            f"a process that worked here was ended from outside, for want of memory perhaps: "
            f"{VARIABLE}=1 does with this one"
        ) from broken


def each(work: Work, shared: Any, items: Sequence[Any], far: bool = True) -> list[Any]:
    """Return work(shared, item) of every item in order: in threads, or as `spreading` says.

    Not `far`: in threads in any case, for work that is done sooner than it is sent.
    """
    spread = _SPREAD.get()
    if not (far and spread.spreads and len(items) > 1):
        return in_threads(lambda item: work(shared, item), items)
    made = dict(spread.map(work, shared, items))
    return [made[at] for at in range(len(items))]


@contextmanager
def spreading(spread: Spread) -> Iterator[None]:
    """Have `each` spread its work over processes or a cluster."""
    before = _SPREAD.set(spread)
    try:
        yield
    finally:
        _SPREAD.reset(before)


Work = Callable[[Any, Any], Any]
"""work(shared, task) -> result; importable by name, so that another process can run it."""

_PATIENCE_S, _MOMENT_S = 15, 0.2


@dataclass(frozen=True)
class Spread:
    """`jobs` processes on this machine, or the Dask scheduler at an address (`tcp://host:port`)."""

    jobs: int = 1
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.jobs < 1:
            raise BenchError(f"--jobs {self.jobs}: expected a whole number of at least 1")
        if self.scheduler and self.jobs > 1:
            raise BenchError("--jobs and --scheduler: expected one of them")

    @property
    def spreads(self) -> bool:
        """True where work leaves this process."""
        return self.jobs > 1 or self.scheduler is not None

    def map(self, work: Work, shared: Any, tasks: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield (position, work(shared, task)) as they finish, in no order.

        Raises BenchError where the scheduler cannot be reached or dask is not installed; what
        `work` raises comes through.
        """
        if self.scheduler:
            return _on_dask(self.scheduler, work, shared, tasks)
        if self.jobs > 1 and len(tasks) > 1:
            return _in_processes(min(self.jobs, len(tasks)), work, shared, tasks)
        return ((number, work(shared, task)) for number, task in enumerate(tasks))


_SPREAD: ContextVar[Spread] = ContextVar("spread", default=Spread())  # noqa: B039 - frozen


def _in_processes(
    jobs: int, work: Work, shared: Any, tasks: Sequence[Any]
) -> Iterator[tuple[int, Any]]:
    pool = _pool(jobs, shared)
    try:
        with _starting():
            waiting = {pool.submit(_call, work, task): at for at, task in enumerate(tasks)}
        for done in as_completed(waiting):
            yield waiting[done], done.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _pool(jobs: int, shared: Any, start: str = "spawn") -> ProcessPoolExecutor:
    """Return a pool of processes that hold what all tasks share."""
    # spawn: a forked child of a process with threads (torch, numba) may hang
    packed = pickle.dumps(shared)  # once, not once per process
    return ProcessPoolExecutor(jobs, multiprocessing.get_context(start), _install, (packed,))


@contextmanager
def _starting() -> Iterator[None]:
    """Have processes that start meanwhile ended by an interruption without a word of theirs.

    It waits until they are far enough for that (see `_install`).
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # its start would let the signal through
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _no_script() -> Iterator[None]:
    """Have processes that start meanwhile find an empty script, to run before their work."""
    with _ONE_SCRIPT:
        script, sys.modules["__main__"] = sys.modules["__main__"], ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = script


_ONE_SCRIPT = Lock()
_ONE_AT_A_TIME = Lock()
_INSTALLED: list[Any] = []  # one per worker process: what all its tasks share


def _install(packed: bytes) -> None:
    """Begin a worker: one thread, since there are as many workers as were asked for."""
    _end_when_interrupted()
    Thread(target=_end_with_parent, daemon=True).start()
    os.environ["OMP_NUM_THREADS"] = "1"  # torch reads it when it is imported
    os.environ[VARIABLE] = "1"
    if (torch := sys.modules.get("torch")) is not None:
        torch.set_num_threads(1)
    _INSTALLED[:] = [pickle.loads(packed)]  # noqa: S301 - from the process that started this one


def _end_when_interrupted() -> None:
    """End this worker at an interruption, also one that came while it started; see `_starting`.

    Not where its parent was told to go on (in the background, say): it goes on then, too.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _end_with_parent() -> None:
    """End this worker as soon as the process that started it is gone, killed included."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _call(work: Work, task: Any) -> Any:
    return work(_INSTALLED[0], task)


def _on_dask(
    address: str, work: Work, shared: Any, tasks: Sequence[Any]
) -> Iterator[tuple[int, Any]]:
    from_dask = _dask()
    with _client(from_dask, address) as client:
        everywhere = client.scatter(shared, broadcast=True)
        futures = [client.submit(_alone, work, everywhere, task, pure=False) for task in tasks]
        waiting = {future.key: at for at, future in enumerate(futures)}
        for done in from_dask.as_completed(futures, loop=client.loop):
            yield waiting[done.key], done.result()


def _alone(work: Work, shared: Any, task: Any) -> Any:
    """One piece at a time per process: seeds of libraries belong to the process, not the thread."""
    with _ONE_AT_A_TIME:
        return work(shared, task)


def _dask() -> Any:
    try:
        import distributed
    except ImportError as problem:
        raise BenchError(
            "--scheduler needs dask.distributed: pip install 'uwb-bench[dask]'"
        ) from problem
    return distributed


@contextmanager
def _client(from_dask: Any, address: str) -> Iterator[Any]:
    try:
        client = from_dask.Client(address, timeout=_PATIENCE_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as problem:
        raise BenchError(
            f"--scheduler {address}: no Dask scheduler answers there "
            "(expected an address such as tcp://host:8786)"
        ) from problem
    try:
        yield client
    finally:
        client.close()
