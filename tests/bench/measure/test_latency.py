"""Timing in fresh processes: what is measured, and what one bad target may not spoil."""

from __future__ import annotations

import os
import statistics
import time
from pathlib import Path

import pytest

from bench.errors import BenchError
from bench.measure import latency, quiet
from bench.measure.latency import THROUGHPUT_ROWS, Timing, TimingTarget, measure
from bench.measure.quiet import Patience
from bench.measure.samples import undisturbed as honest_undisturbed

TOY = '''
"""Runners of known cost and known faults."""
import os, sys, time
import numpy as np

def per_row(path, threads):
    step = float(path.read_text())
    def run(x):
        end = time.perf_counter() + step * len(x)
        while time.perf_counter() < end:
            pass
        return x.sum(axis=1)
    return run

def big(path, threads):
    weights = np.ones(60 * 2**20 // 8)
    return lambda x: x[:, 0] * weights[0]

def prints(path, threads):
    print("loading"); os.write(1, b"from C too\\n")
    return lambda x: (print("called"), x[:, 0])[1]

def raises(path, threads):
    raise RuntimeError("not a model")

def wrong_shape(path, threads):
    return lambda x: x

def dies(path, threads):
    print("out of memory, aborting", file=sys.stderr); sys.stderr.flush(); os._exit(7)

def hangs(path, threads):
    time.sleep(600)

def fails_later(path, threads):
    start = time.perf_counter()
    def run(x):
        if time.perf_counter() > start + 0.1:
            os.kill(os.getpid(), 9)
        return x[:, 0]
    return run

def threads_seen(path, threads):
    path.write_text(f"{threads} {os.environ['OMP_NUM_THREADS']} {os.getpid()}")
    return lambda x: x[:, 0]
'''


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a maker of targets that run functions of the module above."""
    (tmp_path / "toy_runners.py").write_text(TOY)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(latency, "SAMPLE_S", 2e-4)
    monkeypatch.setattr(latency, "undisturbed", lambda rounds, level_us: list(rounds))

    def target(function: str, content: str = "", width: int = 20) -> TimingTarget:
        path = tmp_path / f"{function}{content}.onnx"
        path.write_text(content)
        return TimingTarget(path, f"toy_runners:{function}", width, label=f"toy {function}")

    return target


def test_a_runner_of_known_cost_is_timed_right_at_every_batch(toy) -> None:
    seen: list[float] = []
    [found] = measure([toy("per_row", "3e-4")], rounds=6, progress=seen.append)
    assert isinstance(found, Timing)
    one, four = found.latency
    assert (one.batch, four.batch) == (1, 4)
    assert one.median_us >= 300  # it cannot return earlier; how much later is the machine's
    assert four.median_us >= 1200
    assert four.median_us > 2 * one.median_us
    assert one.low_us <= one.median_us <= one.high_us <= max(one.samples_us)
    assert len(one.samples_us) == 6 * latency.SAMPLES_PER_ROUND
    assert 0 < found.throughput_rows_per_s <= 1 / 3e-4
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_throughput_is_rows_over_the_median_time_of_a_large_batch(toy, monkeypatch) -> None:
    times_us: list[float] = []

    def ask(self, **request):
        answer = honest(self, **request)
        if request["do"] == "round":
            times_us.extend(answer.get(str(THROUGHPUT_ROWS), {"samples_us": []})["samples_us"])
        return answer

    honest = latency.WorkerProcess.ask
    monkeypatch.setattr(latency.WorkerProcess, "ask", ask)
    [found] = measure([toy("per_row", "1e-5")], rounds=6)
    assert len(times_us) == 2  # every third round
    expected = THROUGHPUT_ROWS / (statistics.median(times_us) * 1e-6)
    assert found.throughput_rows_per_s == pytest.approx(expected, rel=1e-9)


class Told:
    """A load that answers what it is told to, then that others use nothing."""

    limit = 0.25

    def __init__(self, *answers: float) -> None:
        self.cores, self.answers = [0, 1], list(answers)

    def due(self) -> bool:
        return True

    def others(self) -> float:
        return self.answers.pop(0) if self.answers else 0.0


def test_on_a_busy_machine_there_is_no_figure_and_a_reason(toy, monkeypatch) -> None:
    monkeypatch.setattr(latency, "undisturbed", honest_undisturbed)
    monkeypatch.setattr(latency, "Load", lambda: Told(*[2.0] * 100))
    [found] = measure([toy("per_row", "1e-5")], rounds=8)
    assert isinstance(found, Timing)
    assert (found.latency, found.throughput_rows_per_s) == ([], None)
    assert "the machine was busy: 0 of 8 rounds were undisturbed" in found.withheld
    assert (found.rounds, found.dropped) == (8, 8)
    assert found.peak_memory_bytes >= 0


def test_with_patience_disturbed_rounds_are_taken_again(toy, monkeypatch) -> None:
    # Others come back for the first three rounds: those are dropped, and more taken.
    monkeypatch.setattr(
        latency, "undisturbed", lambda rounds, _: [r for r in rounds if r.others <= 0]
    )
    monkeypatch.setattr(latency, "Load", lambda: Told(0, 0, 0, 2.0, 2.0, 2.0))
    monkeypatch.setattr(quiet, "POLL_S", 0.01)
    [found] = measure([toy("per_row", "1e-5")], rounds=8, patience=Patience(60))
    assert found.withheld is None
    assert (found.rounds, found.dropped) == (11, 3)


def test_a_target_with_narrow_intervals_is_done_before_the_others(toy, monkeypatch) -> None:
    def quick_ones_are_narrow(rounds) -> float:
        return 0.0 if statistics.median(rounds[0].samples_us) < 150 else 1.0

    monkeypatch.setattr(latency, "width", quick_ones_are_narrow)
    narrow, wide = measure([toy("per_row", "1e-6"), toy("per_row", "2e-4")], rounds=12)
    assert isinstance(narrow, Timing)
    assert isinstance(wide, Timing)
    assert (narrow.rounds, wide.rounds) == (latency.FIRST_ROUNDS, 12)


def test_a_figure_has_a_ratio_to_the_reference_loop(toy) -> None:
    [found] = measure([toy("per_row", "3e-4")], rounds=6)
    one = found.latency[0]
    apart = one.reference_ratio * found.reference_us / one.median_us
    assert 0.2 < apart < 5  # the reference beside a sample may be slowed on its own


def test_quick_calls_are_looped_and_slow_ones_are_not(toy) -> None:
    quick, slow = measure([toy("per_row", "1e-6"), toy("per_row", "2e-4")], rounds=6)
    assert quick.calls_per_sample[1] > 1
    assert slow.calls_per_sample[1] == 1
    assert slow.calls_per_sample[THROUGHPUT_ROWS] == 1


def test_peak_memory_is_what_the_model_takes_not_the_interpreter(toy) -> None:
    big, small = measure([toy("big"), toy("per_row", "1e-6")], rounds=6)
    assert 60 * 2**20 <= big.peak_memory_bytes < 80 * 2**20
    assert small.peak_memory_bytes < 10 * 2**20


@pytest.mark.parametrize(
    ("function", "said"),
    [
        ("raises", "timing toy raises failed: RuntimeError: not a model"),
        ("wrong_shape", r"1 CIRs gave an answer of shape \(1, 20\)"),
        ("dies", r"the worker ended \(exit code 7\): out of memory, aborting"),
        ("absent", "has no attribute 'absent'"),
        ("fails_later", r"the worker ended \(killed by signal 9\)"),
    ],
)
def test_a_bad_target_fails_alone_with_one_clear_line(toy, function, said) -> None:
    bad, good = measure([toy(function), toy("per_row", "1e-5")], rounds=6)
    assert isinstance(bad, BenchError)
    assert isinstance(good, Timing)
    with pytest.raises(BenchError, match=said) as caught:
        raise bad
    assert "\n" not in str(caught.value)


def test_a_hanging_target_is_given_up(toy) -> None:
    [hung] = measure([toy("hangs")], rounds=6, timeout_s=2.0)
    assert "timing toy hangs failed: no answer within 2 s" in str(hung)


def test_what_a_runner_prints_does_not_disturb_the_protocol(toy) -> None:
    [found] = measure([toy("prints")], rounds=6)
    assert isinstance(found, Timing)


def test_each_target_has_a_fresh_process_with_one_thread_that_ends(toy) -> None:
    first, second = toy("threads_seen", "a"), toy("threads_seen", "b")
    measure([first, second], rounds=6)
    threads, omp, pid = first.path.read_text().split()
    assert (threads, omp) == ("1", "1")
    assert pid != second.path.read_text().split()[2]
    assert int(pid) != os.getpid()
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid), 0)


def test_an_interrupt_leaves_no_worker_behind(toy) -> None:
    target = toy("threads_seen")

    def interrupt(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        measure([target], rounds=6, progress=interrupt)
    pid = int(target.path.read_text().split()[2])
    time.sleep(0.05)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_too_few_rounds_are_refused() -> None:
    with pytest.raises(BenchError, match="at least 6"):
        measure([], rounds=5)


def test_no_targets_no_timings() -> None:
    assert measure([]) == []


def test_workers_are_pinned_where_the_system_allows(toy) -> None:
    if not hasattr(os, "sched_getaffinity"):
        pytest.skip("this system does not pin")
    [found] = measure([toy("per_row", "1e-6")], rounds=6)
    assert found.core == max(os.sched_getaffinity(0))
