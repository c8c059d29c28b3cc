"""Work in forks gives what it gives here, whatever becomes of a fork."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from threading import Lock

import pytest

from bench import forked
from bench.forked import both, forking, in_forks

linux = pytest.mark.skipif(sys.platform != "linux", reason="forks are for Linux")


@pytest.fixture(autouse=True)
def _allowed(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("BENCH_THREADS", "3")
    with forking(True):
        yield


def _who(item: int) -> tuple[int, int]:
    return item * item, os.getpid()


def test_what_comes_back_is_in_order() -> None:
    assert [square for square, _ in in_forks(_who, range(100))] == [n * n for n in range(100)]


def test_two_pieces_of_work_each_give_their_own() -> None:
    assert both(lambda: 3, lambda: "three") == (3, "three")


@linux
def test_forks_do_a_part_of_it() -> None:
    all_three = get_context("fork").Barrier(3)

    def together(_: int) -> int:
        all_three.wait(60)  # whoever takes the first piece goes on once the others have one
        return os.getpid()

    assert len({*in_forks(together, range(3))}) == 3


def test_without_leave_threads_or_the_first_thread_all_is_done_here(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with forking(False):
        assert {at for _, at in in_forks(_who, range(20))} == {os.getpid()}
    with ThreadPoolExecutor(1) as pool:
        assert {at for _, at in pool.submit(in_forks, _who, range(20)).result()} == {os.getpid()}
    monkeypatch.setenv("BENCH_THREADS", "1")
    assert {at for _, at in in_forks(_who, range(20))} == {os.getpid()}


@linux
def test_what_a_fork_dies_of_is_done_here() -> None:
    here = os.getpid()

    def deadly(item: int) -> int:
        if os.getpid() != here:
            os._exit(9)
        return item

    assert in_forks(deadly, range(30)) == [*range(30)]


@linux
def test_a_fork_that_hangs_is_waited_for_no_longer_than_that(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    here = os.getpid()
    monkeypatch.setattr(forked, "_PATIENCE_S", 0.2)

    def stuck(item: int) -> int:
        while os.getpid() != here:
            pass
        return item

    assert in_forks(stuck, range(5)) == [*range(5)]


def test_what_work_raises_is_raised() -> None:
    def wrong(item: int) -> int:
        raise ZeroDivisionError(str(item))

    with pytest.raises(ZeroDivisionError):
        in_forks(wrong, range(4))


@linux
def test_what_cannot_be_sent_is_made_here() -> None:
    def locked(item: int) -> tuple[int, object]:
        return item, Lock()

    assert [item for item, _ in in_forks(locked, range(6))] == [*range(6)]


@linux
def test_no_pipe_and_no_process_is_left() -> None:
    gc.collect()  # what earlier tests left open may be closed at any moment
    files, children = _open_files(), _children()
    for _ in range(3):
        in_forks(_who, range(10))
    assert not _open_files() - files
    assert not _children() - children


def _open_files() -> set[str]:
    return {file.name for file in Path("/proc/self/fd").iterdir() if file.exists()}


def _children() -> set[str]:
    return set(Path(f"/proc/self/task/{os.getpid()}/children").read_text().split())
