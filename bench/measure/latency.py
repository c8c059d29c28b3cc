"""How long a model takes on this machine, measured so that the figures can be compared.

Each configuration has a fresh process of its own: one thread, pinned to one core where the system
allows, warmed up. A sample is the mean of enough calls to last `SAMPLE_S`, thousands of times the
clock's resolution and long enough to hold the same mixture of fast and slow calls as any longer
loop. Rounds go through all configurations in a new random order each time, so that whatever
drifts (frequency, temperature, neighbours) drifts for all of them alike. Only one worker runs at
any moment.

Every round holds a reference loop too, the same work each time, just before and just after the
samples, and how much of the machine others used. What these show to be disturbed is dropped
(`undisturbed` says when); more is taken while there is patience, until six rounds are left; where
fewer are there is no figure, and `withheld` says why. A figure also stands as a ratio to the
reference loop. Throughput is taken in every third round.

A target is done as soon as the intervals of its medians are narrow (`NARROW`), after `FIRST_ROUNDS`
at least and `ROUNDS` at most: the others go on. An interval that was looked at until it was narrow
errs a little towards narrow; it is 96 % at the first look of nine rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import BenchError
from bench.measure.energy import EnergyMeter, NoMeter, energy_per_call
from bench.measure.quiet import Load, Patience
from bench.measure.samples import (
    FEWEST_ROUNDS,
    Round,
    reference_level,
    summarise,
    undisturbed,
    width,
)
from bench.measure.timing_process import WorkerProcess
from bench.parallel import threads
from bench.results import Interval, Latency

Progress = Callable[[float], None]
BATCHES = (1, 4)
THROUGHPUT_ROWS = 256
SAMPLE_S = 0.002
ROUNDS = 15
FIRST_ROUNDS = 9  # the interval is then from the second smallest to the second largest: 96 %
MORE_ROUNDS = 3  # between two looks
NARROW = 0.06  # of the median
THROUGHPUT_EVERY = 3  # rounds: a large batch takes as long as all else
SAMPLES_PER_ROUND = 3
TIMEOUT_S = 120.0
MOST = 3  # times the rounds asked for, before it is given up


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

    `withheld` says why there is no `latency` (then empty) and no throughput: the machine was busy.
    `rounds` were taken, of which `dropped` were disturbed; `reference_us` is the reference loop's
    level. `throughput_rows_per_s` is the median with batches of `THROUGHPUT_ROWS`;
    `peak_memory_bytes` is the most resident memory that opening the file and calling it with each
    batch of `latency` took above the interpreter with its runtime imported. `calls_per_sample`
    says, by batch, how many calls each raw sample is the mean of. `core` is the one pinned to.
    """

    latency: list[Latency]
    throughput_rows_per_s: float | None
    peak_memory_bytes: int
    energy_mj: Interval | None
    energy_how: str
    calls_per_sample: dict[int, int] = field(default_factory=dict)
    core: int | None = None
    rounds: int = 0
    dropped: int = 0
    reference_us: float | None = None
    withheld: str | None = None


def measure(
    targets: Sequence[TimingTarget],
    rounds: int = ROUNDS,
    batches: Sequence[int] = BATCHES,
    progress: Progress | None = None,
    meter: EnergyMeter | None = None,
    timeout_s: float = TIMEOUT_S,
    seed: int = 0,
    patience: Patience | None = None,
) -> list[Timing | BenchError]:
    """Time every target; return one `Timing` each, or the BenchError why that one failed.

    `rounds` (at least 6) is the most interleaved rounds of 3 samples per batch, fewer where nine
    give narrow intervals; `progress`
    is called with the fraction done; `meter` reads the energy counters of this machine where it
    has any; `seed` drives the order within rounds. `patience` waits for a quiet machine before,
    and takes up to three times the rounds where some are disturbed; without it nothing waits. A
    target that crashes or takes longer than
    `timeout_s` for one request fails alone. Raises BenchError for fewer rounds.
    """
    if rounds < FEWEST_ROUNDS:
        raise BenchError(f"{rounds} timing rounds give no 95 % interval: at least 6 are needed")
    with ExitStack() as stack:
        runs = [_Run(target, list(batches), stack, timeout_s) for target in targets]
        _open_all(runs)
        for run in runs:
            run.step(run.calibrate)
        session = _Session(runs, np.random.default_rng(seed), progress or (lambda _: None))
        session.take(rounds, patience or Patience(0))
        return [run.result(meter or NoMeter("not asked for")) for run in runs]


def _open_all(runs: list[_Run]) -> None:
    """Start the workers, as many at once as there are threads: nothing is timed yet."""
    at_once = threads()
    for run in runs[:at_once]:
        run.step(run.start)
    for at, run in enumerate(runs):
        run.step(run.await_open)
        for following in runs[at + at_once : at + at_once + 1]:
            following.step(following.start)


class _Session:
    """Rounds over all targets, with what others did meanwhile."""

    def __init__(self, runs: list[_Run], order: np.random.Generator, progress: Progress) -> None:
        self.runs, self.order, self.progress = runs, order, progress
        self.load = Load()

    def take(self, rounds: int, patience: Patience) -> None:
        """Take rounds of every target until it has enough, or patience is at its end."""
        patience.await_quiet(self.load)
        self._some(self.runs, min(FIRST_ROUNDS, rounds), rounds)
        while wanting := [run for run in self.runs if run.wants(rounds, patience.left)]:
            if any(run.taken >= rounds for run in wanting):  # more than planned: others disturb
                patience.await_quiet(self.load)
            self._some(wanting, MORE_ROUNDS, rounds)
        self.progress(1.0)

    def _some(self, runs: list[_Run], count: int, most: int) -> None:
        """Take some rounds, asking after the load as often as it can be told."""
        self.load.others()
        before = max((run.taken for run in runs), default=0)
        for done in range(count):
            for position, k in enumerate(self.order.permutation(len(runs))):
                runs[k].step(runs[k].sample)
                self.progress(min(1.0, (before + done + (position + 1) / len(runs)) / most))
            if self.load.due() or done + 1 == count:
                excess = self.load.others() - self.load.limit
                for run in runs:
                    run.beside(excess)


class _Run:
    """One target on its way: its worker, its samples, and the error that ended it, if any."""

    def __init__(
        self, target: TimingTarget, batches: list[int], stack: ExitStack, timeout_s: float
    ) -> None:
        self.target, self.batches = target, batches
        self.error: BenchError | None = None
        self.rounds: dict[int, list[Round]] = {b: [] for b in [*batches, THROUGHPUT_ROWS]}
        self._fresh: list[Mapping[str, Any]] = []
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
        counts = dict.fromkeys(self.batches, SAMPLES_PER_ROUND)
        if (self.taken + len(self._fresh)) % THROUGHPUT_EVERY == 0:
            counts[THROUGHPUT_ROWS] = 1  # one lasts long enough
        self._fresh.append(self.worker.ask(do="round", samples=counts))

    def beside(self, excess: float) -> None:
        """Note how many cores too many others used during the rounds since the last note."""
        for answer in self._fresh:
            for batch, one in answer.items():
                flanks = (one["reference_us"][0], one["reference_us"][1])
                taken = Round(one["samples_us"], flanks, one["core_share"], excess)
                self.rounds[int(batch)].append(taken)
        self._fresh.clear()

    def kept(self) -> dict[int, list[Round]]:
        """Return the undisturbed rounds by batch."""
        level_us = self._level_us()
        return {batch: undisturbed(some, level_us) for batch, some in self.rounds.items()}

    def undisturbed(self) -> int:
        """Return the number of undisturbed rounds of the latency batch that has the fewest."""
        kept = self.kept()
        return min(len(kept[batch]) for batch in self.batches)

    @property
    def taken(self) -> int:
        """The rounds taken."""
        return len(self.rounds[self.batches[0]])

    def wants(self, rounds: int, patient: bool) -> bool:
        """Tell whether more rounds would help: up to `rounds`, thrice as many while `patient`.

        Beyond `rounds` only where too few of them were undisturbed.
        """
        if self.error is not None:
            return False
        enough = self.undisturbed() >= FEWEST_ROUNDS
        if enough and (self.taken >= rounds or self._narrow()):
            return False
        return self.taken < (MOST * rounds if patient else rounds)

    def _narrow(self) -> bool:
        kept = self.kept()
        return all(width(kept[batch]) <= NARROW for batch in self.batches)

    def _level_us(self) -> float:
        return reference_level([one for some in self.rounds.values() for one in some])

    def result(self, meter: EnergyMeter) -> Timing | BenchError:
        """Return the finished timing, or why there is none."""
        self.step(lambda: self._measure_energy(meter))
        if self.error is not None:
            return self.error
        kept, taken = self.kept(), self.taken
        enough = self.undisturbed() >= FEWEST_ROUNDS
        return Timing(
            latency=[summarise(b, kept[b]) for b in self.batches] if enough else [],
            throughput_rows_per_s=_throughput(kept[THROUGHPUT_ROWS]) if enough else None,
            peak_memory_bytes=self.opened["peak_memory_bytes"],
            energy_mj=self.energy_mj,
            energy_how=meter.how,
            calls_per_sample=self.calls,
            core=self.opened["core"],
            rounds=taken,
            dropped=taken - self.undisturbed(),
            reference_us=self._level_us(),
            withheld=None if enough else self._why(taken),
        )

    def _why(self, taken: int) -> str:
        return (
            f"the machine was busy: {self.undisturbed()} of {taken} rounds were undisturbed, "
            f"at least {FEWEST_ROUNDS} are needed"
        )

    def _measure_energy(self, meter: EnergyMeter) -> None:
        def burst(seconds: float) -> int:
            answer = self.worker.ask(do="burst", batch=self.batches[0], seconds=seconds)
            return int(answer["calls"])

        self.energy_mj = energy_per_call(meter, burst)


def _throughput(rounds: Sequence[Round]) -> float | None:
    """Return rows per second from the median time of the large batch; None without one."""
    if not rounds:
        return None
    bulk_us = float(np.median([one.samples_us for one in rounds]))
    return THROUGHPUT_ROWS * 1e6 / bulk_us
