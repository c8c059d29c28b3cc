"""A simulator in two halves, so that effects on the range alone cost no new waveform."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import count

import numpy as np

from bench.discrepancy.compare.prefix_cache import Prefixes
from bench.discrepancy.data.observables import (
    COUNT,
    RANGE,
    SCALARS,
    Floats,
    Observables,
    Window,
    collect,
    shape_of,
)
from bench.discrepancy.settings import (
    KEPT_NOISE,
    KEPT_PATH_REPLICATES,
    KEPT_REPLICATES,
    KEPT_ROWS,
    KEPT_STEPS,
    STACKED_ROWS,
)
from bench.errors import BenchError
from bench.physics.batch import Batch, altered
from bench.physics.memory import Memory, keep_freed
from bench.physics.pipeline import EffectError, Pipeline, Run, in_order
from bench.physics.randomness import BLOCK, Draws
from bench.physics.remembered import DrawMemory, RememberedDraws
from bench.physics.scene import Scene
from bench.physics.simulator import Simulator
from bench.physics.stacked import StackedDraws, joined

Numbers = tuple[int, ...]  # of replicates


@dataclass(frozen=True)
class Detected:
    """Replicates after detection: a batch per block without its waveform, and CIR figures.

    Of one replicate, or of several that stand under each other in one block.
    """

    blocks: tuple[Batch, ...]
    shape: dict[str, Floats]


class Stages:
    """Simulates replicates; remembers everything before the ranging stage.

    Numbers are those of `Simulator.observe` with the same seed and replicate.
    """

    def __init__(self, window: Window) -> None:
        keep_freed()
        self.window = window
        self._detections: dict[bool, Memory[Detected]] = {
            True: Memory(KEPT_REPLICATES),
            False: Memory(KEPT_PATH_REPLICATES),
        }
        self._drawn = DrawMemory(KEPT_NOISE)
        self._prefixes = Prefixes(KEPT_STEPS)
        self._places: Memory[tuple[Scene, int]] = Memory(KEPT_ROWS)
        self._numbers = count()

    def observables(
        self, simulator: Simulator, rows: Scene, replicate: int, cir: bool
    ) -> Observables:
        """Return what the simulator gives for `rows` in one replicate."""
        return self.ensemble(simulator, rows, (replicate,), cir)[0]

    def ensemble(
        self, simulator: Simulator, rows: Scene, replicates: Sequence[int], cir: bool
    ) -> list[Observables]:
        """Return what the simulator gives for `rows` in each of some replicates."""
        most = max(1, STACKED_ROWS // max(len(rows), 1))
        parts = [tuple(replicates[at : at + most]) for at in range(0, len(replicates), most)]
        return [one for part in parts for one in self._stacked(simulator, rows, part, cir)]

    def _stacked(
        self, simulator: Simulator, rows: Scene, numbers: Numbers, cir: bool
    ) -> list[Observables]:
        """Return what the simulator gives in some replicates, simulated at once.

        Where that fails, one by one: so the first that fails is blamed.
        """
        try:
            found = self._found(simulator, rows, numbers, cir)
            blocks = [self._ranged(simulator, b, rows, numbers) for b in enumerate(found.blocks)]
        except Exception as problem:
            if len(numbers) > 1:
                return [self.observables(simulator, rows, number, cir) for number in numbers]
            if isinstance(problem, BenchError) and not isinstance(problem, EffectError):
                raise
            raise self._blamed(simulator, rows, numbers[0], cir, problem) from problem
        return _collected(blocks, found.shape, len(numbers))

    def variants(
        self, simulators: Sequence[Simulator], rows: Scene, replicate: int, cir: bool
    ) -> list[Observables | None]:
        """Return what simulators that differ in one effect give for `rows` in one replicate.

        None where one cannot simulate them.
        """
        most = max(1, STACKED_ROWS // max(len(rows), 1))
        parts = [simulators[at : at + most] for at in range(0, len(simulators), most)]
        return [one for part in parts for one in self._side_by_side(part, rows, replicate, cir)]

    def _side_by_side(
        self, simulators: Sequence[Simulator], rows: Scene, replicate: int, cir: bool
    ) -> Sequence[Observables | None]:
        """Return `variants` of a few simulators: at once, else one by one."""
        if len(simulators) > 1:
            with suppress(Exception):
                return self._varied(simulators, rows, replicate, cir)
        made: list[Observables | None] = []
        for simulator in simulators:
            try:
                made.append(self.observables(simulator, rows, replicate, cir))
            except BenchError:
                made.append(None)
        return made

    def _varied(
        self, simulators: Sequence[Simulator], rows: Scene, replicate: int, cir: bool
    ) -> list[Observables]:
        """Simulate each up to the effect that differs, then all of them at once.

        Raises ValueError where none or more than one differs before detection.
        """
        first, count = simulators[0], len(simulators)
        alone, together = (
            self._draws(first.seed, rows, (replicate,) * many, 0) for many in (1, count)
        )
        chains = [_pipeline(one, alone, cir).steps(alone) for one in simulators]
        at = _where_they_differ([[key for key, _ in steps] for steps in chains])
        run = self._run((self._place(rows), (replicate,)), first, alone, cir)
        heads = [run(lambda: first.base.paths(rows), steps[: at + 1]) for steps in chains]
        pipeline = _pipeline(first, together, cir)
        batch = joined(heads, rows.repeated(count))
        batch = pipeline.detect(in_order(lambda: batch, pipeline.steps(together)[at + 1 :]))
        shape = self._shape(first, batch)
        return _collected([pipeline.ranged(batch, together)], shape, count)

    def _found(self, simulator: Simulator, rows: Scene, numbers: Numbers, cir: bool) -> Detected:
        """Return some replicates up to detection, remembered."""
        early = tuple(e for e in simulator.effects if e.stage != "ranging")
        key = (self._place(rows), simulator.base, early, simulator.seed, numbers, cir)
        made = partial(self._detected, simulator, rows, numbers, cir)
        return self._detections[cir].get(key, made, len(numbers))

    def _detected(self, simulator: Simulator, rows: Scene, numbers: Numbers, cir: bool) -> Detected:
        """Simulate up to detection; the waveform is reduced to its figures and dropped."""
        blocks, shapes = [], []
        for start in range(0, len(rows), BLOCK):
            part = rows.slice(start, start + BLOCK)
            draws = self._draws(simulator.seed, part, numbers, start // BLOCK)
            place = (self._place(rows), numbers)
            batch = self._received(simulator, part.repeated(len(numbers)), draws, cir, place)
            shapes.append(self._shape(simulator, batch))
            blocks.append(altered(batch, waveform=None, noise=None, magnitude=None))
        names = shapes[0]
        shape = {name: np.concatenate([part[name] for part in shapes]) for name in names}
        return Detected(tuple(blocks), shape)

    def _draws(self, seed: int, rows: Scene, numbers: Numbers, block: int) -> Draws:
        """Return the draws of a block of rows in some replicates."""
        key = (seed, numbers[0], "base", block)
        if len(numbers) == 1:
            return RememberedDraws(*key, self._drawn)
        return StackedDraws(*key, numbers, (rows,) * len(numbers), self._drawn)

    def _place(self, rows: Scene) -> Hashable:
        """Return a number for these rows, theirs for good: forgotten rows come back as new ones.

        Rows are held while they are remembered, so that no others have their identity.
        """
        return self._places.get(id(rows), lambda: (rows, next(self._numbers)))[1]

    def _blamed(
        self, simulator: Simulator, rows: Scene, replicate: int, cir: bool, problem: Exception
    ) -> BenchError:
        """Return an error that names the first row that fails on its own, and why.

        No row where every one fails: the fault is the simulator's then.
        """
        reason = f"{problem}".splitlines()[0] if f"{problem}" else type(problem).__name__
        said = f"simulator {simulator.name!r} fails on"
        ones = [rows.slice(at, at + 1) for at in {0, len(rows) // 2, len(rows) - 1}]
        if len(ones) > 1 and all(self._fails(simulator, one, replicate, cir) for one in ones):
            return BenchError(f"{said} {len(rows)} rows at once and on single ones: {reason}")
        low, high = 0, len(rows)
        while high - low > 1:
            middle = (low + high) // 2
            part = rows.slice(low, middle)
            low, high = (
                (low, middle) if self._fails(simulator, part, replicate, cir) else (middle, high)
            )
        return BenchError(
            f"{said} row {low} of the {len(rows)} it was given "
            f"(true range {rows.true_range_m[low]:.4g} m): {reason}"
        )

    def _fails(self, simulator: Simulator, rows: Scene, replicate: int, cir: bool) -> bool:
        """Return whether a simulator cannot simulate some rows."""
        try:
            draws = Draws(simulator.seed, replicate, "base", 0)
            _after_ranging(simulator, self._received(simulator, rows, draws, cir), draws)
        except Exception:
            return True
        return False

    def _received(
        self,
        simulator: Simulator,
        rows: Scene,
        draws: Draws,
        cir: bool,
        place: tuple[Hashable, Numbers] | None = None,
    ) -> Batch:
        """Return a block of rows after detection, before the ranging stage.

        `place` says which rows they are, and of which replicates, so that the same beginnings are
        not simulated again.
        """
        pipeline = _pipeline(simulator, draws, cir)
        if place is None:
            return pipeline.detected(lambda: simulator.base.paths(rows), draws)
        run = self._run(place, simulator, draws, cir)
        return pipeline.detected(lambda: simulator.base.paths(rows), draws, run)

    def _run(
        self, place: tuple[Hashable, Numbers], simulator: Simulator, draws: Draws, cir: bool
    ) -> Run:
        """Return what runs steps on rows of replicates, and remembers beginnings."""
        key = (place, simulator.base, draws.seed, draws.block, cir)
        return partial(self._prefixes.run, key, many=len(place[1]))

    def _ranged(
        self, simulator: Simulator, numbered: tuple[int, Batch], rows: Scene, numbers: Numbers
    ) -> Batch:
        """Return a detected block, with its number, after the ranging stage."""
        block, batch = numbered
        part = rows.slice(block * BLOCK, (block + 1) * BLOCK)
        return _after_ranging(simulator, batch, self._draws(simulator.seed, part, numbers, block))

    def _shape(self, simulator: Simulator, batch: Batch) -> dict[str, Floats]:
        """Return the CIR figures of a detected batch, none without a waveform."""
        crop = simulator.base.cropped(batch)
        if crop is None:
            return {}
        whole, index = crop
        told = {name: _column(batch, name) for name in (COUNT, "noise_std")}
        return shape_of(whole, index, batch.sample_period_ns, self.window, told)


def _pipeline(simulator: Simulator, draws: Draws, cir: bool) -> Pipeline:
    """Return the stages of a simulator; without `cir` no waveform is received."""
    base = simulator.base

    def received(batch: Batch) -> Batch:
        return base.received(batch, draws) if cir else base.counted(batch)

    return Pipeline(simulator.effects, received, base.detected)


def _after_ranging(simulator: Simulator, batch: Batch, draws: Draws) -> Batch:
    """Return a detected batch after the ranging stage."""
    return _pipeline(simulator, draws, False).ranged(batch, draws)


def _where_they_differ(chains: Sequence[Sequence[Hashable]]) -> int:
    """Return the one place where chains of steps differ. Raises ValueError where it is not one."""
    if len({len(chain) for chain in chains}) > 1:
        raise ValueError("chains of other lengths")
    places = [at for at, steps in enumerate(zip(*chains, strict=True)) if len(set(steps)) > 1]
    if len(places) != 1:
        raise ValueError(f"chains that differ in {len(places)} places")
    return places[0]


def _collected(blocks: Sequence[Batch], shape: dict[str, Floats], count: int) -> list[Observables]:
    """Return the observables of each of `count` stacked replicates, of ranged blocks."""
    scalars = {n: np.concatenate([_column(block, n) for block in blocks]) for n in SCALARS}
    parts = zip(_parts(scalars, count), _parts(shape, count), strict=True)
    return [collect(*part) for part in parts]


def _parts(columns: dict[str, Floats], count: int) -> list[dict[str, Floats]]:
    """Return the columns [count n] of every replicate [n]."""
    each = {name: column.reshape(count, -1) for name, column in columns.items()}
    return [{name: parts[i] for name, parts in each.items()} for i in range(count)]


def _column(batch: Batch, name: str) -> Floats:
    """Return an observable column of a detected batch [n]."""
    if name == RANGE:
        assert batch.range_m is not None
        return np.asarray(batch.range_m - batch.rows.true_range_m, np.float64)
    found = batch.symbols if name == COUNT else getattr(batch, name)
    return np.full(len(batch), np.nan) if found is None else np.asarray(found, np.float64)
