"""The method, in the order of a page.

split -> compare -> (locate -> explain -> order -> add -> fit again -> prune) -> verdicts ->
confirm. Every step is a function of the module it is imported from; `kept(step)` is the same step,
its result remembered where a journal is kept, so that a diagnosis that was stopped goes on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, Comparison, View, view, without
from bench.discrepancy.confirm import Confirmed, confirm, improves
from bench.discrepancy.data.checks import check_recorded
from bench.discrepancy.data.columns import hidden
from bench.discrepancy.data.observables import Window, window_of
from bench.discrepancy.data.split import LinkSplit, Rows, link_codes, split_links, thinned
from bench.discrepancy.fit.residual_curve import unnamed_effect
from bench.discrepancy.locate.permutation_test import Located
from bench.discrepancy.select.backfitting import polished, settled
from bench.discrepancy.select.candidates import Contender, Explanation, library
from bench.discrepancy.select.conclude import verdicts
from bench.discrepancy.select.state import Progress, Round, Search, Selection, State, silent
from bench.discrepancy.select.stepwise import (
    best_contender,
    contradicted,
    explain_left,
    locate_left,
    margin,
    order,
    prune,
    strike_links,
    struck_round,
    with_contender,
    witnessed_by_links,
)
from bench.discrepancy.select.verdict import Unknown
from bench.discrepancy.settings import MOST_ROUNDS
from bench.physics.effect import Effect
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings


@dataclass(frozen=True)
class Options:
    """How much is done: rows used for search, fit and confirmation, the seed, what is compared.

    `waveform` False simulates from paths alone (see `View`).
    """

    seed: int = 0
    search_rows: int = 2000
    fit_rows: int = 500
    confirm_rows: int = 2000
    hide: tuple[str, ...] = ()
    observables: tuple[str, ...] | None = None
    waveform: bool = True


@dataclass(frozen=True)
class Diagnosis:
    """A finished diagnosis; `simulator` has the effects added, None where a table was compared."""

    source: str
    simulated: str
    selection: Selection
    added: Added
    confirmed: Confirmed
    split: LinkSplit
    simulator: Simulator | None
    mix: dict[str, tuple[float, float]] = field(default_factory=dict)
    options: Options = field(default_factory=Options)


def diagnose(
    recorded: Recordings,
    simulated: Simulator | Recordings,
    options: Options | None = None,
    progress: Progress = silent,
    kinds: Mapping[str, type[Effect]] | None = None,
    journal: Journal | None = None,
) -> Diagnosis:
    """Diagnose `recorded` against a simulator or a table. Raises BenchError on bad input.

    `kinds` restricts the library. Deterministic from `options.seed`. What a `journal` keeps of an
    earlier, unfinished diagnosis of the same input is not done again.
    """
    asked, journal = options or Options(), journal or Journal()
    check_recorded(recorded)
    rows = _WorkingRows.of(recorded, asked)
    comparison = compared_with(simulated, rows.window, asked.seed)
    every, skipped = library()
    search = _search(comparison, rows, kinds or every, progress)
    journal.know(search.kinds)
    found = select_effects(search, journal)
    found = replace(found, skipped={**skipped, **found.skipped})
    added = (*found.added, *_unnamed(search, found))
    progress("confirming on links that nothing was tuned on")
    confirmed = confirm(comparison, rows.confirm(), added, asked.seed)
    after = comparison.with_effects(added) if isinstance(comparison, Resimulation) else None
    mix = comparison.mix(search.discover) if isinstance(comparison, TableComparison) else {}
    name = simulated.label if isinstance(simulated, Recordings) else simulated.name
    return Diagnosis(recorded.label, name, found, added, confirmed, rows.split, after, mix, asked)


@dataclass(frozen=True)
class _WorkingRows:
    """A recorded table, split by link into what is searched, fitted and, sealed, confirmed."""

    recorded: Recordings
    asked: Options
    split: LinkSplit
    window: Window

    @classmethod
    def of(cls, recorded: Recordings, asked: Options) -> _WorkingRows:
        """Return a recorded table without hidden columns, split."""
        shown = replace(recorded, frame=hidden(recorded.frame, asked.hide))
        split = split_links(shown.frame, asked.seed)
        return cls(shown, asked, split, window_of(shown.frame))

    def view(self, rows: Rows, most: int) -> View:
        """Return at most about `most` of some rows, evenly from every link."""
        codes, asked = link_codes(self.recorded.frame), self.asked
        kept = thinned(rows, codes, most)
        frame = self.recorded.frame
        return view(frame, codes, kept, self.window, asked.observables, asked.waveform)

    def confirm(self) -> View:
        """Open the sealed links. Raises RuntimeError the second time."""
        return self.view(self.split.confirm.open(), self.asked.confirm_rows)


def compared_with(simulated: Simulator | Recordings, window: Window, seed: int) -> Comparison:
    """Return the counterpart of the recorded rows: a simulator run again, or a table's rows."""
    if isinstance(simulated, Recordings):
        return TableComparison(simulated.frame, window, seed)
    return Resimulation(simulated, window)


def _search(
    comparison: Comparison,
    rows: _WorkingRows,
    kinds: Mapping[str, type[Effect]],
    progress: Progress,
) -> Search:
    """Return the search over the working rows; where no waveform is simulated, over all of them."""
    asked = rows.asked
    discover = rows.view(rows.split.discover, asked.search_rows)
    fit = rows.view(rows.split.fit, asked.fit_rows)
    work = None if asked.waveform else rows.view(rows.split.work, asked.search_rows)
    return Search(comparison, discover, fit, kinds, asked.seed, progress, work)


def select_effects(search: Search, journal: Journal | None = None) -> Selection:
    """Go round until nothing significant is left, and say what was found."""
    journal = journal or Journal()
    state = State(search)
    for turn in journal.rounds(MOST_ROUNDS):
        search.progress(f"searching (round {turn + 1})")
        state = one_round(state, turn, journal)
        if state.finished:
            break
    return concluded(state, journal)


def one_round(state: State, turn: int, journal: Journal) -> State:
    """Locate what is left, explain it, and add what explains it best."""
    kept = journal.kept
    state, located = _located(state, turn, journal)
    search, added = state.search, state.added
    if not located.significant:
        return state.after(Round(located, None, None), finished=True)
    explanation = kept(explain_left)(search, added, located)
    explanation = kept(order)(search, added, explanation)
    best = best_contender(explanation)
    best = best or kept(witnessed_by_links)(search, added, explanation)
    struck = kept(strike_links)(search, added, best)
    if struck:
        state = state.after(struck_round(located, explanation, struck))
        search = search.spared(struck)
        added = kept(polished)(search.comparison, search.fit, added)  # by what was not struck
        return replace(state, search=search, added=added)
    if best is None:
        return state.after(Round(located, explanation, None), finished=True)
    return _with_best(state, located, explanation, best, journal)


def _located(state: State, turn: int, journal: Journal) -> tuple[State, Located]:
    """Return what differs; an effect that this contradicts is taken out first."""
    located = journal.kept(locate_left)(state.search, state.added, turn)
    refuted = contradicted(state.added, located)
    if refuted is None:
        return state, located
    search, added = state.search.without(refuted), without(state.added, refuted)
    located = journal.kept(locate_left)(search, added, turn)
    return replace(state, search=search, added=added), located


def _with_best(
    state: State, located: Located, explanation: Explanation, best: Contender, journal: Journal
) -> State:
    """Return the state with the best contender added, all fitted again, the needless taken out."""
    search, before = state.search, state.added
    state = state.after(Round(located, explanation.led_by(best), best.effect))
    added = with_contender(before, best)
    if len(added) > 1 or search.fit.waveform:
        anew = len(added) > 1
        added = journal.kept(polished)(search.comparison, search.fit, added, anew=anew)
        least = journal.kept(margin)(search, added)
        added = journal.kept(prune)(search, added, least, best.effect, located)
    if {e.name for e in added} <= {e.name for e in before}:  # what was added was taken out again
        known = best.effect.name in search.kinds
        return replace(state, search=search.without(best.effect), added=added, finished=not known)
    return replace(state, added=added)


def concluded(state: State, journal: Journal) -> Selection:
    """Fit what was chosen once more on all working rows, and say what can be said."""
    search, added = state.search, state.added
    if search.work is not None and added:
        added = journal.kept(settled)(search.comparison, search.work, added)
    said = journal.kept(verdicts)(search, state.rounds, added)
    struck = tuple(turn.strike.effect for turn in state.rounds if turn.strike)
    named = tuple(e for e in (*struck, *added) if any(e.physics in v.names for v in said))
    return Selection(said, named, state.rounds, state.skipped)


def _unnamed(search: Search, found: Selection) -> Added:
    """Return a curve for a mismatch without a name, if it predicts links it was not fitted on."""
    rest = tuple(v for v in found.verdicts if isinstance(v, Unknown))
    if not rest:
        return ()
    extra = unnamed_effect(search.comparison, search.fit, found.added, rest[0].findings)
    if extra is None:
        return ()
    both = (*found.added, extra)
    helps = improves(search.comparison, search.discover, found.added, both, search.seed)
    return (extra,) if helps else ()
