"""How long a model takes on this machine, measured so that the figures can be compared.

Each configuration has a fresh process of its own: one thread, pinned to one core where the system
allows, warmed up. A sample is the mean of enough calls to last `SAMPLE_S`, thousands of times the
clock's resolution and long enough to hold the same mixture of fast and slow calls as any longer
loop. Rounds go through all configurations in a new random order each time, so that whatever
drifts (frequency, temperature, neighbours) drifts for all of them alike. Only one worker runs at
any moment.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bench.errors import BenchError
from bench.measure.energy import EnergyMeter, NoMeter, energy_per_call
from bench.measure.samples import FEWEST_ROUNDS, summarise
from bench.measure.timing_process import WorkerProcess
from bench.results import Interval, Latency

Progress = Callable[[float], None]
BATCHES = (1, 4)
THROUGHPUT_ROWS = 256
SAMPLE_S = 0.002
ROUNDS = 20
SAMPLES_PER_ROUND = 5
TIMEOUT_S = 120.0


@dataclass(frozen=True)
class TimingTarget:
    """A file to time: `opener` is "module:function" called with (path, threads).

    `width` is the number of CIR samples in a row, `label` names the target in error messages, and
    the modules of `preload` are imported before memory is measured, where they exist.
    """

    path: Path
    opener: str
    width: int
    label: str = ""
    preload: tuple[str, ...] = ("onnxruntime",)


@dataclass(frozen=True)
class Timing:
    """Measured speed and memory of one target.

    `throughput_rows_per_s` is the median with batches of `THROUGHPUT_ROWS`; `peak_memory_bytes`
    is the most resident memory that opening the file and calling it with each batch of `latency`
    took above the interpreter with its runtime imported. `calls_per_sample` says, by batch, how
    many calls each raw sample is the mean of. `core` is the one pinned to, or None.
    """

    latency: list[Latency]
    throughput_rows_per_s: float
    peak_memory_bytes: int
    energy_mj: Interval | None
    energy_how: str
    calls_per_sample: dict[int, int] = field(default_factory=dict)
    core: int | None = None


def measure(
    targets: Sequence[TimingTarget],
    rounds: int = ROUNDS,
    batches: Sequence[int] = BATCHES,
    progress: Progress | None = None,
    meter: EnergyMeter | None = None,
    timeout_s: float = TIMEOUT_S,
    seed: int = 0,
) -> list[Timing | BenchError]:
    """Time every target; return one `Timing` each, or the BenchError why that one failed.

    `rounds` (at least 6) is the number of interleaved rounds of 5 samples per batch; `progress`
    is called with the fraction done; `meter` reads the energy counters of this machine where it
    has any; `seed` drives the order within rounds. A target that crashes or takes longer than
    `timeout_s` for one request fails alone. Raises BenchError for fewer rounds.
    """
    if rounds < FEWEST_ROUNDS:
        raise BenchError(f"{rounds} timing rounds give no 95 % interval: at least 6 are needed")
    with ExitStack() as stack:
        runs = [_Run(target, list(batches), stack, timeout_s) for target in targets]
        _open_all(runs)
        for run in runs:
            run.step(run.calibrate)
        order = np.random.default_rng(seed)
        for done in _rounds(runs, rounds, order):
            if progress:
                progress(done)
        return [run.result(meter or NoMeter("not asked for")) for run in runs]


def _open_all(runs: list[_Run]) -> None:
    """Start the workers, as many at once as there are cores: nothing is timed yet."""
    at_once = os.cpu_count() or 1
    for first in range(0, len(runs), at_once):
        for run in runs[first : first + at_once]:
            run.step(run.start)
        for run in runs[first : first + at_once]:
            run.step(run.await_open)


def _rounds(runs: list[_Run], rounds: int, order: np.random.Generator) -> Iterator[float]:
    """Take every round of samples, yielding the fraction done."""
    for done in range(rounds):
        for position, k in enumerate(order.permutation(len(runs))):
            runs[k].step(runs[k].sample)
            yield (done + (position + 1) / len(runs)) / rounds


class _Run:
    """One target on its way: its worker, its samples, and the error that ended it, if any."""

    def __init__(
        self, target: TimingTarget, batches: list[int], stack: ExitStack, timeout_s: float
    ) -> None:
        self.target, self.batches = target, batches
        self.error: BenchError | None = None
        self.samples: dict[int, list[list[float]]] = {b: [] for b in [*batches, THROUGHPUT_ROWS]}
        self.shares: dict[int, list[float]] = {batch: [] for batch in self.samples}
        self.calls: dict[int, int] = {}
        self._own, self._timeout_s = stack.enter_context(ExitStack()), timeout_s

    def step(self, work: Callable[[], None]) -> None:
        """Do one step unless an earlier one failed; a failure ends this target alone."""
        if self.error is None:
            try:
                work()
            except BenchError as error:
                self.error = error
                self._own.close()

    def start(self) -> None:
        """Start the worker and have it open the file."""
        target = self.target
        label = target.label or target.path.name
        self.worker = self._own.enter_context(WorkerProcess(label, self._timeout_s))
        self.worker.send(
            do="open",
            path=str(target.path),
            opener=target.opener,
            width=target.width,
            batches=self.batches,
            rows=THROUGHPUT_ROWS,
            preload=target.preload,
        )

    def await_open(self) -> None:
        """Wait until the file is open."""
        self.opened = self.worker.receive()

    def calibrate(self) -> None:
        """Warm up and choose the calls per sample."""
        answer = self.worker.ask(do="calibrate", sample_s=SAMPLE_S)
        self.calls = {int(batch): calls for batch, calls in answer["calls"].items()}

    def sample(self) -> None:
        """Take one round of samples of every batch."""
        for batch, rounds in self.samples.items():
            count = 1 if batch == THROUGHPUT_ROWS else SAMPLES_PER_ROUND  # one lasts long enough
            answer = self.worker.ask(do="sample", batch=batch, samples=count)
            rounds.append(answer["samples_us"])
            self.shares[batch].append(answer["core_share"])

    def result(self, meter: EnergyMeter) -> Timing | BenchError:
        """Return the finished timing, or why there is none."""
        self.step(lambda: self._measure_energy(meter))
        if self.error is not None:
            return self.error
        bulk_us = float(np.median(self.samples[THROUGHPUT_ROWS]))
        return Timing(
            latency=[summarise(b, self.samples[b], self.shares[b]) for b in self.batches],
            throughput_rows_per_s=THROUGHPUT_ROWS * 1e6 / bulk_us,
            peak_memory_bytes=self.opened["peak_memory_bytes"],
            energy_mj=self.energy_mj,
            energy_how=meter.how,
            calls_per_sample=self.calls,
            core=self.opened["core"],
        )

    def _measure_energy(self, meter: EnergyMeter) -> None:
        def burst(seconds: float) -> int:
            answer = self.worker.ask(do="burst", batch=self.batches[0], seconds=seconds)
            return int(answer["calls"])

        self.energy_mj = energy_per_call(meter, burst)
