"""What a search begins from: both tables side by side, the rows that take part, the library."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.discrepancy.compare.radio import base_of
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.sound import tried
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, Comparison
from bench.discrepancy.confirm import Confirmed
from bench.discrepancy.counterpart import beside, counted, covered
from bench.discrepancy.data.checks import check_tables
from bench.discrepancy.data.columns import hidden, with_motion
from bench.discrepancy.data.gaps import gap_words, with_temperatures
from bench.discrepancy.data.observables import Window, shared_window
from bench.discrepancy.data.own_columns import doubtful_columns, measured_columns
from bench.discrepancy.data.unread import unread_words
from bench.discrepancy.diagnosis import Diagnosis, Options
from bench.discrepancy.report.evidence import evidence
from bench.discrepancy.select.candidates import library, offered
from bench.discrepancy.select.state import Progress, Search, Selection
from bench.discrepancy.settings import EVIDENCE_ROWS
from bench.discrepancy.with_waveforms import decided
from bench.discrepancy.working import WorkingRows
from bench.errors import about
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.simulator import Simulator
from bench.recordings.places import cut_into_places, link_count
from bench.recordings.table import Recordings

Kinds = Mapping[str, type[Effect]]


@dataclass(frozen=True)
class Prepared:
    """A recorded table beside its counterpart, with effects that can be tried on it.

    `untried` are effects whose inputs are lacking; `skipped` says of what is left out why. All
    else is as `Diagnosis` has it.
    """

    source: str
    simulated: str
    comparison: Comparison
    base: Base
    rows: WorkingRows
    able: Kinds
    untried: Kinds
    skipped: Mapping[str, str]
    measured: tuple[str, ...]
    links: tuple[int, int]
    counted: tuple[str, ...]
    uncovered: float

    def search(self, progress: Progress) -> Search:
        """Return the search over the working rows; without waveforms over all of them."""
        rows, asked = self.rows, self.rows.asked
        discover = rows.view(rows.split.discover, asked.search_rows)
        fit = rows.view(rows.split.fit, asked.fit_rows)
        work = None if asked.waveform else rows.view(rows.split.work, asked.search_rows)
        return Search(
            self.comparison, discover, fit, self.able, asked.seed, progress, work,
            doubtful=rows.doubtful, untried=self.untried,
        )  # fmt: skip

    def diagnosis(self, found: Selection, added: Added, confirmed: Confirmed) -> Diagnosis:
        """Return what was found, with what it was found from."""
        comparison, rows = self.comparison, self.rows
        discover = rows.view(rows.split.discover, rows.asked.search_rows)
        after = comparison.with_effects(added) if isinstance(comparison, Resimulation) else None
        mix = comparison.mix(discover) if isinstance(comparison, TableComparison) else {}
        kept = evidence(comparison, rows.view(rows.split.work, EVIDENCE_ROWS))
        return Diagnosis(
            self.source, self.simulated, found, added, confirmed, rows.split, after, mix,
            rows.asked, self.uncovered, self.base, evidence=kept, measured=self.measured,
            links=self.links, counted=self.counted,
        )  # fmt: skip


def prepared(
    recorded: Recordings,
    simulated: Simulator | Recordings,
    options: Options | None = None,
    kinds: Kinds | None = None,
) -> Prepared:
    """Return what a search of `kinds`, or of the library, begins from.

    Raises BenchError on bad input.
    """
    options = options or Options()
    asked = decided(options, recorded, simulated)
    check_tables(recorded, simulated, bool(asked.waveform))
    numbers = counted(recorded, simulated, options.waveform is None)
    whole = hidden(recorded.frame, asked.hide)
    frame = cut_into_places(with_temperatures(whole))
    measured = measured_columns(frame, asked.measured, asked.known)
    shown = replace(recorded, frame=with_motion(hidden(frame, measured)))
    against = _Against.of(shown, beside(recorded, simulated), asked)
    inside = covered(against.comparison, shown)
    doubtful = frame[list(doubtful_columns(measured, asked.measured))].iloc[np.flatnonzero(inside)]
    rows = WorkingRows.of(shown.select(inside), asked, doubtful, against.window)
    every, skipped = library()
    asked_for, rerun = kinds or every, isinstance(against.comparison, Resimulation)
    able, lacking = offered(asked_for, rows.recorded.frame, bool(asked.waveform), rerun)
    untried = {name: asked_for[name] for name in lacking}
    return Prepared(
        recorded.label, _name(simulated), against.comparison, against.base, rows, able, untried,
        {**skipped, **lacking}, measured,
        (link_count(whole), link_count(frame)),
        (*numbers, *gap_words(whole), *unread_words(whole, measured), *against.said),
        1 - float(inside.mean()),
    )  # fmt: skip


def _name(simulated: Simulator | Recordings) -> str:
    """Return what a simulator or a table is called."""
    return simulated.label if isinstance(simulated, Recordings) else simulated.name


@dataclass(frozen=True)
class _Against:
    """What recorded rows are compared with, its settings, and what a user should know of it."""

    comparison: Comparison
    window: Window
    base: Base
    said: tuple[str, ...]

    @classmethod
    def of(cls, shown: Recordings, simulated: Simulator | Recordings, asked: Options) -> _Against:
        """Return the counterpart of the rows that are shown."""
        with about(shown.at):
            base = base_of(shown.frame, simulated)
        said = tried(simulated, base, shown.frame, bool(asked.waveform))
        window = shared_window(shown.frame, getattr(simulated, "frame", None))
        return cls(compared_with(simulated, window, asked.seed, base), window, base, said)


def compared_with(
    simulated: Simulator | Recordings, window: Window, seed: int, base: Base
) -> Comparison:
    """Return the counterpart of the recorded rows: a simulator run again, or a table's rows."""
    if isinstance(simulated, Recordings):
        return TableComparison(simulated.frame, window, seed, base)
    return Resimulation(replace(simulated, base=base), window)
