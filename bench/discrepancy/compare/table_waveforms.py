"""Effects on the waveforms of another simulator's table: its matched rows, changed.

Several matched versions are changed at once where they are of few rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress

import numpy as np
import pandas as pd

from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.covariates import MEASURED
from bench.discrepancy.data.observables import (
    COUNT,
    SCALARS,
    Floats,
    Observables,
    Window,
    collect,
    shape_of,
)
from bench.discrepancy.data.split import Rows
from bench.discrepancy.settings import KEPT_NOISE, KEPT_SHAPES, KEPT_TABLES, STACKED_ROWS
from bench.physics.base import Base
from bench.physics.foreign import ForeignTable
from bench.physics.foreign_stack import StackedTables
from bench.physics.memory import Memory
from bench.physics.outcome import Outcome
from bench.physics.own_detector import telling
from bench.physics.remembered import DrawMemory

Shape = dict[str, Floats]


class TableWaveforms:
    """Rows of a table, which effects change; remembers the latest.

    `error_m` gives the errors [n] of the rows that stand for those of a view; `base` the radio:
    the channel turns what reflections add.
    """

    def __init__(
        self,
        frame: pd.DataFrame,
        error_m: Callable[[View, Rows], Floats],
        window: Window,
        seed: int,
        base: Base,
    ) -> None:
        self.frame, self.error_m, self.window, self.seed = frame, error_m, window, seed
        self.base, self._drawn = base, DrawMemory(KEPT_NOISE)
        self._told_by = ForeignTable(frame.iloc[telling(len(frame))], base)
        self._tables: Memory[ForeignTable] = Memory(KEPT_TABLES)
        self._stacks: Memory[StackedTables] = Memory(KEPT_TABLES)
        self._shapes: Memory[Shape] = Memory(KEPT_SHAPES)

    def changed(
        self, view: View, picks: Sequence[Rows], added: Added, replicates: Sequence[int]
    ) -> list[Observables]:
        """Return matched rows with effects on their CIRs too, at the recorded rows' settings.

        `picks` are the rows [n] of each version, `replicates` whose random numbers it gets.
        """
        most = max(1, STACKED_ROWS // len(view.rows))
        parts = range(0, len(picks), most)
        return [
            one
            for at in parts
            for one in self._some(view, picks[at : at + most], added, replicates[at : at + most])
        ]

    def outcome(self, view: View, pick: Rows, added: Added, replicate: int) -> Outcome:
        """Return one matched version, its samples with it."""
        return self._observed(view, [pick], added, [replicate], True)[0]

    def _some(
        self, view: View, picks: Sequence[Rows], added: Added, replicates: Sequence[int]
    ) -> list[Observables]:
        """Return `changed` of a few versions."""
        early = tuple(effect for effect in added if effect.stage != "ranging")
        pairs = zip(picks, replicates, strict=True)
        keys = [(view.number, pick.tobytes(), early, number) for pick, number in pairs]
        shapes = [self._shapes.find(key) for key in keys]
        made = self._observed(view, picks, added, replicates, any(one is None for one in shapes))
        scalars = [_scalars(one) for one in made]
        if any(one is None for one in shapes):
            fresh = zip(keys, self._figures(made, scalars), strict=True)
            shapes = [self._shapes.keep(key, shape) for key, shape in fresh]
        return [collect(*one) for one in zip(scalars, shapes, strict=True)]

    def _observed(
        self, view: View, picks: Sequence[Rows], added: Added, replicates: Sequence[int], cir: bool
    ) -> list[Outcome]:
        """Return what the table's receiver gives of the versions: at once, else one by one."""
        if len(picks) > 1:
            with suppress(Exception):  # one by one the first that fails says why
                return self._stack(view, picks).observe(added, self.seed, replicates, cir=cir)
        tables = [self._table(view, pick) for pick in picks]
        pairs = zip(tables, replicates, strict=True)
        return [table.observe(added, self.seed, number, cir=cir) for table, number in pairs]

    def _stack(self, view: View, picks: Sequence[Rows]) -> StackedTables:
        """Return several versions, ready for effects to act on all of them."""
        key = (view.number, *(pick.tobytes() for pick in picks))

        def made() -> StackedTables:
            return StackedTables(tuple(self._table(view, pick) for pick in picks))

        return self._stacks.get(key, made, len(picks))

    def _table(self, view: View, pick: Rows) -> ForeignTable:
        """Return matched rows, ready for effects to act on."""

        def made() -> ForeignTable:
            rows = self._rows_at(view, pick)
            return ForeignTable(rows, self.base, memory=self._drawn, like=self._told_by)

        return self._tables.get((view.number, pick.tobytes()), made)

    def _rows_at(self, view: View, pick: Rows) -> pd.DataFrame:
        """Return matched rows: what was measured from the table, all else as recorded."""
        theirs = self.frame.iloc[pick].reset_index(drop=True)
        known = [name for name in view.frame if name not in MEASURED]
        error = self.error_m(view, pick)
        kept = theirs[[name for name in theirs if name in MEASURED]]
        out = pd.concat([view.frame[known].reset_index(drop=True), kept], axis=1)
        return out.assign(error_m=error, range_m=view.scene.true_range_m + error)

    def _figures(self, made: Sequence[Outcome], scalars: Sequence[Shape]) -> list[Shape]:
        """Return the figures of the CIRs of changed rows: effects on the range change none."""
        told = [bool(np.isnan(one[COUNT]).all()) for one in scalars]
        if len(set(told)) > 1:  # samples are taken as they are where no row has a count
            return [self._shape([one], [own]) for one, own in zip(made, scalars, strict=True)]
        every = self._shape(made, scalars)
        parts = {name: values.reshape(len(made), -1) for name, values in every.items()}
        return [{name: part[i] for name, part in parts.items()} for i in range(len(made))]

    def _shape(self, made: Sequence[Outcome], scalars: Sequence[Shape]) -> Shape:
        """Return the figures of the CIRs of some versions, one under the other."""
        cirs = [one.cir for one in made if one.cir is not None]
        first = [one.first_path_index for one in made if one.first_path_index is not None]
        told = {name: np.concatenate([one[name] for one in scalars]) for name in SCALARS}
        period_ns = made[0].sample_period_ns
        return shape_of(np.concatenate(cirs), np.concatenate(first), period_ns, self.window, told)


def _scalars(made: Outcome) -> Shape:
    """Return the observables of a version that are no figures of its CIRs, [n] each."""
    return {name: np.asarray(getattr(made, name), np.float64) for name in SCALARS}
