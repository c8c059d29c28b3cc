"""The load of others, and waiting for it to end."""

from __future__ import annotations

import subprocess
import sys
import time

import psutil
import pytest

from bench.measure import quiet
from bench.measure.quiet import Load, Patience, Reading


@pytest.fixture
def readings(monkeypatch: pytest.MonkeyPatch) -> list[Reading]:
    """Let `Load` read from a list instead of the machine."""
    every: list[Reading] = []
    monkeypatch.setattr(Load, "_read", lambda self: every.pop(0))
    return every


def test_others_are_all_work_less_our_own_over_the_time_between(readings) -> None:
    readings += [Reading(10.0, 100.0, 5.0), Reading(12.0, 103.0, 6.0), Reading(13.0, 103.5, 6.5)]
    load = Load()
    assert load.others() == pytest.approx(1.0)  # 3 s of work, 1 s of it ours, in 2 s
    assert load.others() == pytest.approx(0.0)


def test_counters_that_tick_apart_are_no_negative_load(readings) -> None:
    readings += [Reading(0.0, 0.0, 0.0), Reading(1.0, 0.5, 0.51)]
    assert Load().others() == 0.0


@pytest.mark.parametrize(("cores", "limit"), [(1, 0.25), (2, 0.25), (8, 1.0), (64, 8.0)])
def test_others_may_use_a_quarter_of_a_core_or_an_eighth_of_many(cores, limit, monkeypatch) -> None:
    monkeypatch.setattr(quiet, "_our_cores", lambda: list(range(cores)))
    assert Load().limit == limit


def test_our_own_work_is_not_that_of_others() -> None:
    load = Load()
    end = time.process_time() + 0.6
    while time.process_time() < end:
        pass
    used, ours = load._read(), load._last
    assert used.own_s - ours.own_s == pytest.approx(0.6, abs=0.05)
    assert used.busy_s - ours.busy_s >= 0.5


def test_counters_cover_our_cores_alone() -> None:
    every = psutil.cpu_times(percpu=True)
    whole = quiet._busy_s(list(range(len(every))))
    assert quiet._busy_s([]) == 0
    assert quiet._busy_s([0]) <= whole
    assert quiet._busy_s([10_000]) == 0


class Fading:
    """A load that is over after some answers."""

    limit, cores = 0.25, (0, 1)

    def __init__(self, busy: int) -> None:
        self.busy = busy

    def others(self) -> float:
        self.busy -= 1
        return 1.5 if self.busy > 0 else 0.1


def test_waiting_ends_with_the_load_and_says_what_it_waits_for(monkeypatch) -> None:
    monkeypatch.setattr(quiet, "POLL_S", 0.001)
    said: list[str] = []
    load = Fading(4)
    Patience(60, said.append).await_quiet(load)
    assert load.busy == 0
    assert said == ["waiting for a quiet machine (others use 1.5 of 2 cores)"] * 2


def test_waiting_is_bounded_and_none_by_default_takes_no_time(monkeypatch) -> None:
    monkeypatch.setattr(quiet, "POLL_S", 0.01)
    start = time.monotonic()
    patience = Patience(0.1)
    patience.await_quiet(Fading(10**6))
    assert 0.1 <= time.monotonic() - start < 5
    assert not patience.left
    assert not Patience(0).left


def test_the_work_of_a_child_that_has_ended_is_our_own() -> None:
    before = quiet._own_s()
    code = "import time\nwhile time.process_time() < 0.4: pass"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert quiet._own_s() - before >= 0.35
