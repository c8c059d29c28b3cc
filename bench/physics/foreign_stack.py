"""Effects on several tables of another simulator at once: to the last bit what each gives alone.

Matched rows of a table are taken in several versions, each with draws of its own. They are changed
as one batch (see `bench.physics.stacked`); each is received as its own table was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.foreign import ForeignTable, check_on_tables
from bench.physics.memory import Memory
from bench.physics.outcome import Outcome
from bench.physics.pipeline import Change, Pipeline
from bench.physics.scene import Scene, stacked
from bench.physics.stacked import StackedDraws, joined, split

KEPT_ARRIVING = 2  # without phases of their own and with them


@dataclass(frozen=True)
class StackedTables:
    """Tables of as many rows each, at most a block, with the same base and memory."""

    tables: tuple[ForeignTable, ...]

    @cached_property
    def scenes(self) -> tuple[Scene, ...]:
        """The rows of each table."""
        return tuple(table.rows for table in self.tables)

    @cached_property
    def rows(self) -> Scene:
        """The rows of all tables. Raises ValueError where their columns are not the same."""
        return stacked(self.scenes)

    def observe(
        self, effects: tuple[Effect, ...], seed: int, replicates: Sequence[int], *, cir: bool = True
    ) -> list[Outcome]:
        """Return what each table's `observe` gives for its replicate.

        Raises ValueError where the tables cannot be changed at once, and what effects raise.
        """
        check_on_tables(effects)
        first, memory = self.tables[0], self.tables[0].memory
        draws = StackedDraws(seed, replicates[0], "base", 0, tuple(replicates), self.scenes, memory)
        pipeline = Pipeline(effects, first.own.counted, first.own.detected)
        changed = split(pipeline.ranged(self._detected(effects, draws), draws), self.scenes)
        pairs = zip(self.tables, changed, strict=True)
        return [table.outcome(0, batch, table.plain[0], cir) for table, batch in pairs]

    def _detected(self, effects: tuple[Effect, ...], draws: StackedDraws) -> Batch:
        """Return all rows up to detection; the last are remembered."""
        early = tuple(effect for effect in effects if effect.stage != "ranging")
        key = (early, draws.seed, draws.replicates)
        return self._last.get(key, lambda: self._detect(early, draws))

    @cached_property
    def _last(self) -> Memory[Batch]:
        """The last detected batch."""
        return Memory(1)

    def _detect(self, early: tuple[Effect, ...], draws: StackedDraws) -> Batch:
        """Return all rows up to detection."""
        phased = any(effect.with_phases for effect in early)
        arriving, receivers = self._arriving.get(phased, lambda: self._arrive(phased))

        def receive(batch: Batch) -> Batch:
            pairs = zip(receivers, split(batch, self.scenes), strict=True)
            return joined([received(own) for received, own in pairs], self.rows)

        pipeline = Pipeline(early, receive, self.tables[0].own.detected)
        return pipeline.detected(lambda: arriving, draws)

    @cached_property
    def _arriving(self) -> Memory[tuple[Batch, list[Change]]]:
        """What arrives without effects, and what receives it in each table."""
        return Memory(KEPT_ARRIVING)

    def _arrive(self, phased: bool) -> tuple[Batch, list[Change]]:
        """Return `_arriving`, made."""
        part = slice(0, len(self.scenes[0]))
        each = [table.arriving(part, phased) for table in self.tables]
        pairs = zip(self.tables, each, strict=True)
        return joined(each, self.rows), [table.receiver(part, own) for table, own in pairs]
