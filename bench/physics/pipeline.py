"""The order of a simulation, written once: propagation, receiver, detection, ranging.

Who simulates says what starts it, what receives (a base's waveform, its paths alone, another
simulator's table) and, where beginnings are remembered, how steps are run one after another.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.errors import BenchError
from bench.physics.batch import Batch
from bench.physics.effect import Effect, Stage
from bench.physics.randomness import Draws
from bench.physics.stacked import applied
from bench.text import reason

Change = Callable[[Batch], Batch]
Step = tuple[Hashable, Change]
Run = Callable[[Callable[[], Batch], Sequence[Step]], Batch]


class EffectError(BenchError):
    """An effect that fails, or gives what no effect may give."""


def in_order(start: Callable[[], Batch], steps: Sequence[Step]) -> Batch:
    """Return what the steps make of the start, each on what the one before gave."""
    batch = start()
    for _, change in steps:
        batch = change(batch)
    return batch


@dataclass(frozen=True)
class Pipeline:
    """The stages of one block of rows: `effects` between what receives and what detects.

    Raises BenchError where an effect is listed twice.
    """

    effects: tuple[Effect, ...]
    receive: Change
    detect: Change

    def __post_init__(self) -> None:
        check_once(self.effects)

    def simulated(self, start: Callable[[], Batch], draws: Draws) -> Batch:
        """Return what `start` gives after all stages. Raises EffectError naming one that fails."""
        return self.ranged(self.detected(start, draws), draws)

    def detected(self, start: Callable[[], Batch], draws: Draws, run: Run = in_order) -> Batch:
        """Return the batch up to detection and with it; `run` runs what comes before it."""
        return self.detect(run(start, self.steps(draws)))

    def steps(self, draws: Draws) -> list[Step]:
        """Return what comes before detection."""
        return [
            *self._steps("propagation", draws),
            ("received", self.receive),
            *self._steps("receiver", draws),
        ]

    def ranged(self, batch: Batch, draws: Draws) -> Batch:
        """Return a detected batch after the ranging stage."""
        return in_order(lambda: batch, self._steps("ranging", draws))

    def _steps(self, stage: Stage, draws: Draws) -> list[Step]:
        """Return the effects of a stage as steps, in their order."""
        return [_step(effect, draws) for effect in at_stage(self.effects, stage)]


def check_once(effects: Sequence[Effect], where: str = "") -> None:
    """Raise BenchError where an effect is listed twice; `where` says in what."""
    names = [effect.name for effect in effects]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise BenchError(f"{where}effect {twice!r} is listed twice")


def at_stage(effects: Sequence[Effect], stage: str) -> tuple[Effect, ...]:
    """Return the effects of one stage: as listed, but `first` and `last` before and behind all."""
    found = [effect for effect in effects if effect.stage == stage]
    return tuple(sorted(found, key=lambda effect: (effect.last, not effect.first)))


def _step(effect: Effect, draws: Draws) -> Step:
    """Return an effect as a step with random numbers of its own.

    An effect on the waveform does nothing where there is none.
    """
    own = replace(draws, name=effect.name)

    def change(batch: Batch) -> Batch:
        if effect.stage == "receiver" and batch.waveform is None and not effect.without_cir:
            return batch
        return _checked(effect, batch, own)

    return (type(effect), effect), change


def _checked(effect: Effect, batch: Batch, draws: Draws) -> Batch:
    """Return the batch with one effect. Raises EffectError naming an effect that fails."""
    try:
        with np.errstate(all="ignore"):
            made = applied(effect, batch, draws)
    except BenchError as problem:  # rows that the effect cannot do, said by itself
        raise EffectError(f"effect {effect.name!r}: {problem}") from problem
    except (Exception, SystemExit) as problem:  # a plug-in must not end the program
        raise EffectError(f"effect {effect.name!r} {_failing(problem, len(batch))}") from problem
    if not isinstance(made, Batch):
        raise EffectError(f"effect {effect.name!r} gave {type(made).__name__}, expected a Batch")
    if made.range_m is not None and np.shape(made.range_m) != (len(batch),):
        count = np.size(made.range_m)
        raise EffectError(f"effect {effect.name!r} gave {count} ranges for {len(batch)} rows")
    if made.range_m is not None and not np.isfinite(made.range_m).all():
        bad = int((~np.isfinite(made.range_m)).sum())
        many = f" in {bad} of {len(batch)} rows" if bad < len(batch) else ""
        raise EffectError(f"effect {effect.name!r} gave a range that is no number{many}")
    return made


def _failing(problem: BaseException, rows: int) -> str:
    """Return how an effect failed, in words; arrays of another length are told by their lengths."""
    counts = {int(found) for found in re.findall(r"\((\d+),\)", str(problem))} - {rows}
    if isinstance(problem, ValueError) and "broadcast" in str(problem) and len(counts) == 1:
        return f"gave {counts.pop()} values for {rows} rows"
    return f"failed: {reason(problem)}"
