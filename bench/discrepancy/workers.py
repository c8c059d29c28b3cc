"""Work spread over threads: numpy and compiled loops let go of the interpreter.

What is computed never depends on how many there are: every draw has a key of its own.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")
MOST = 8
VARIABLE = "BENCH_THREADS"


def threads() -> int:
    """Return how many threads to use: BENCH_THREADS, else the cores this process may use."""
    asked = os.environ.get(VARIABLE, "")
    if asked.isdigit() and int(asked) > 0:
        return int(asked)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return max(1, min(cores or 1, MOST))


def in_threads(work: Callable[[T], R], items: Iterable[T]) -> list[R]:
    """Return `work` of every item in order. The first exception, in order, is raised."""
    count = threads()
    if count == 1:
        return [work(item) for item in items]
    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(work, items))
