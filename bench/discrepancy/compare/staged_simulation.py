"""A simulator in two halves, so that effects on the range alone cost no new waveform."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
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
)
from bench.errors import BenchError
from bench.physics.batch import Batch
from bench.physics.memory import Memory, keep_freed
from bench.physics.pipeline import EffectError, Pipeline
from bench.physics.randomness import BLOCK, Draws
from bench.physics.remembered import DrawMemory, RememberedDraws
from bench.physics.scene import Scene
from bench.physics.simulator import Simulator


@dataclass(frozen=True)
class Detected:
    """One replicate after detection: a batch per block without its waveform, and CIR figures."""

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
        early = tuple(e for e in simulator.effects if e.stage != "ranging")
        key = (self._place(rows), simulator.base, early, simulator.seed, replicate, cir)
        try:
            found = self._detections[cir].get(
                key, lambda: self._detected(simulator, rows, replicate, cir)
            )
            batches = [_ranged(simulator, b, replicate, i) for i, b in enumerate(found.blocks)]
        except Exception as problem:
            if isinstance(problem, BenchError) and not isinstance(problem, EffectError):
                raise
            raise self._blamed(simulator, rows, replicate, cir, problem) from problem
        columns = [{name: _column(batch, name) for name in SCALARS} for batch in batches]
        scalars = {name: np.concatenate([part[name] for part in columns]) for name in SCALARS}
        return collect(scalars, found.shape)

    def _detected(self, simulator: Simulator, rows: Scene, replicate: int, cir: bool) -> Detected:
        """Simulate up to detection; the waveform is reduced to its figures and dropped."""
        blocks, shapes = [], []
        for start in range(0, len(rows), BLOCK):
            key = (simulator.seed, replicate, "base", start // BLOCK)
            draws = RememberedDraws(*key, self._drawn)
            part = rows.slice(start, start + BLOCK)
            batch = self._received(simulator, part, draws, cir, self._place(rows))
            shapes.append(self._shape(simulator, batch))
            blocks.append(replace(batch, waveform=None, noise=None, magnitude=None))
        names = shapes[0]
        shape = {name: np.concatenate([part[name] for part in shapes]) for name in names}
        return Detected(tuple(blocks), shape)

    def _place(self, rows: Scene) -> Hashable:
        """Return a number for these rows, theirs for good: forgotten rows come back as new ones.

        Rows are held while they are remembered, so that no others have their identity.
        """
        return self._places.get(id(rows), lambda: (rows, next(self._numbers)))[1]

    def _blamed(
        self, simulator: Simulator, rows: Scene, replicate: int, cir: bool, problem: Exception
    ) -> BenchError:
        """Return an error that names the first row that fails on its own, and why."""
        low, high = 0, len(rows)
        while high - low > 1:
            middle = (low + high) // 2
            part = rows.slice(low, middle)
            low, high = (
                (low, middle) if self._fails(simulator, part, replicate, cir) else (middle, high)
            )
        reason = f"{problem}".splitlines()[0] if f"{problem}" else type(problem).__name__
        return BenchError(
            f"simulator {simulator.name!r} fails on row {low} of the {len(rows)} it was given "
            f"(true range {rows.true_range_m[low]:.4g} m): {reason}"
        )

    def _fails(self, simulator: Simulator, rows: Scene, replicate: int, cir: bool) -> bool:
        """Return whether a simulator cannot simulate some rows."""
        try:
            draws = Draws(simulator.seed, replicate, "base", 0)
            _ranged(simulator, self._received(simulator, rows, draws, cir), replicate, 0)
        except Exception:
            return True
        return False

    def _received(
        self, simulator: Simulator, rows: Scene, draws: Draws, cir: bool, place: Hashable = None
    ) -> Batch:
        """Return a block of rows after detection, before the ranging stage.

        `place` says which rows they are, so that the same beginnings are not simulated again.
        """
        base = simulator.base

        def received(batch: Batch) -> Batch:
            return base.received(batch, draws) if cir else base.counted(batch)

        key = (place, base, draws.seed, draws.replicate, draws.block, cir)
        run = self._prefixes.run if place is not None else Prefixes(1).run
        pipeline = Pipeline(simulator.effects, received, base.detected)
        return pipeline.detected(lambda: base.paths(rows), draws, partial(run, key))

    def _shape(self, simulator: Simulator, batch: Batch) -> dict[str, Floats]:
        """Return the CIR figures of a detected batch, none without a waveform."""
        crop = simulator.base.cropped(batch)
        if crop is None:
            return {}
        whole, index = crop
        told = {name: _column(batch, name) for name in (COUNT, "noise_std")}
        return shape_of(whole, index, batch.sample_period_ns, self.window, told)


def _ranged(simulator: Simulator, batch: Batch, replicate: int, block: int) -> Batch:
    """Return a detected block after the ranging stage."""
    base = simulator.base
    draws = Draws(simulator.seed, replicate, "base", block)
    return Pipeline(simulator.effects, base.counted, base.detected).ranged(batch, draws)


def _column(batch: Batch, name: str) -> Floats:
    """Return an observable column of a detected batch [n]."""
    if name == RANGE:
        assert batch.range_m is not None
        return np.asarray(batch.range_m - batch.rows.true_range_m, np.float64)
    found = batch.symbols if name == COUNT else getattr(batch, name)
    return np.full(len(batch), np.nan) if found is None else np.asarray(found, np.float64)
