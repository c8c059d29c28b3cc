"""A simulator: a base, an ordered list of effects and a seed. The same seed, the same numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import pandas as pd

from bench.errors import unknown_name
from bench.parallel import in_threads
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.outcome import Outcome, joined, outcome
from bench.physics.pipeline import Pipeline, at_stage, check_once
from bench.physics.randomness import BLOCK, Draws
from bench.physics.scene import Scene, scene
from bench.recordings.table import Recordings


@dataclass(frozen=True)
class Simulator:
    """Base + effects + seed; effects act in the order of their stages, then as listed.

    >>> from bench.physics import Base, Simulator
    >>> simulated = Simulator(Base()).simulate(recordings, seed=0)  # doctest: +SKIP
    """

    base: Base = field(default_factory=Base)
    effects: tuple[Effect, ...] = ()
    seed: int = 0
    name: str = "simulator"

    def __post_init__(self) -> None:
        check_once(self.effects, f"simulator {self.name!r}: ")

    def with_effect(self, effect: Effect) -> Simulator:
        """Return the simulator with `effect` added, or put in place of the one of its name."""
        names = [known.name for known in self.effects]
        if effect.name not in names:
            return replace(self, effects=(*self.effects, effect))
        place = names.index(effect.name)
        return replace(self, effects=(*self.effects[:place], effect, *self.effects[place + 1 :]))

    def without(self, name: str) -> Simulator:
        """Return the simulator without the effect of that name. Raises BenchError if absent."""
        if name not in [known.name for known in self.effects]:
            raise unknown_name("effect", name, [known.name for known in self.effects])
        return replace(self, effects=tuple(e for e in self.effects if e.name != name))

    @property
    def of_samples(self) -> bool:
        """Whether levels hang on samples: on overlapping paths, a tail, or what receivers add.

        Paths alone give the mean of these, not how they scatter.
        """
        kinds = [type(effect) for effect in self.effects]
        return any(kind.dies_away or not kind.without_cir for kind in kinds)

    def at_stage(self, stage: str) -> tuple[Effect, ...]:
        """Return its effects of one stage: as listed, those marked `last` behind the others."""
        return at_stage(self.effects, stage)

    def simulate(
        self, geometry: Recordings | pd.DataFrame, seed: int | None = None, replicate: int = 0
    ) -> Recordings:
        """Simulate every row of a table at its own geometry and settings.

        All columns of `geometry` are kept; range, error, CIR, powers, noise and count are
        simulated. Raises BenchError where the true range is not known in every row.
        """
        from bench.physics.toml_file import to_toml

        frame = geometry.frame if isinstance(geometry, Recordings) else geometry
        source = geometry.source if isinstance(geometry, Recordings) else "geometry"
        seed = self.seed if seed is None else seed
        made = self.observe(scene(frame, source), seed, replicate)
        text = to_toml(replace(self, seed=seed))
        return Recordings(made.table(frame), self.name, "simulated", simulator=text, seed=seed)

    def observe(
        self,
        rows: Scene,
        seed: int | None = None,
        replicate: int = 0,
        *,
        cir: bool = True,
        complex_cir: bool = False,
        first_row: int = 0,
    ) -> Outcome:
        """Return what the chip would report for `rows`, as arrays; cheap to call repeatedly.

        `replicate` numbers independent draws of the same seed. Without `cir` no waveform is
        made: ranges and powers come from the paths alone, some ten times faster.
        `first_row`, a multiple of BLOCK, is where `rows` begin in a table simulated in chunks.
        """
        starts = range(0, len(rows), BLOCK)

        def block(start: int) -> Outcome:
            number = (first_row + start) // BLOCK
            draws = Draws(self.seed if seed is None else seed, replicate, "base", number)
            batch = self._block(rows.slice(start, start + BLOCK), draws, cir)
            return outcome(batch, self.base, complex_cir=complex_cir)

        return joined(in_threads(block, starts))

    def ensemble(
        self, rows: Scene, replicates: int, seed: int | None = None, *, cir: bool = True
    ) -> Iterator[Outcome]:
        """Yield `replicates` independent outcomes for the same rows."""
        for replicate in range(replicates):
            yield self.observe(rows, seed, replicate, cir=cir)

    def _block(self, rows: Scene, draws: Draws, cir: bool) -> Batch:
        """Return one block of at most BLOCK rows after all stages."""
        base = self.base

        def receive(batch: Batch) -> Batch:
            return base.received(batch, draws) if cir else base.counted(batch)

        pipeline = Pipeline(self.effects, receive, base.detected)
        return pipeline.simulated(lambda: base.paths(rows), draws)
