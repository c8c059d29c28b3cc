"""The method, in the order of a page.

split -> compare -> (locate -> explain -> order -> add -> fit again -> prune) -> verdicts ->
confirm. Each step is a function; `kept(step)` is the same, remembered in a journal for a next run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.radio import base_of
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.sound import tried
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.untimed import untimed
from bench.discrepancy.compare.view import Added, Comparison, without
from bench.discrepancy.confirm import Confirmed, confirm
from bench.discrepancy.counterpart import beside, counted, covered
from bench.discrepancy.data.checks import check_tables
from bench.discrepancy.data.columns import hidden, text_instead, with_motion
from bench.discrepancy.data.observables import Window, shared_window
from bench.discrepancy.data.own_columns import doubtful_columns, measured_columns
from bench.discrepancy.data.split import LinkSplit
from bench.discrepancy.headline import NEW_SIMULATOR, NEW_TABLE, headline, or_elsewhere
from bench.discrepancy.joint import turn as waves
from bench.discrepancy.law.found import FoundLaw, SetupFault
from bench.discrepancy.law.named_faults import without_a_name
from bench.discrepancy.law.unexplained import borne_out, weighed
from bench.discrepancy.locate.permutation_test import Located
from bench.discrepancy.report.evidence import Evidence, evidence
from bench.discrepancy.select.backfitting import polished, settled
from bench.discrepancy.select.candidates import Contender, Explanation, library, offered
from bench.discrepancy.select.circle import Circle
from bench.discrepancy.select.conclude import of_the_rest, verdicts
from bench.discrepancy.select.control_curve import with_curve
from bench.discrepancy.select.elsewhere import elsewhere_too
from bench.discrepancy.select.last_round import last_round, unexplained
from bench.discrepancy.select.left_said import as_it_stands
from bench.discrepancy.select.level_slope import with_absorption, with_slope
from bench.discrepancy.select.logged import with_logs
from bench.discrepancy.select.marks import seen_first, with_marks
from bench.discrepancy.select.range_word import spoilt_ranges
from bench.discrepancy.select.refute import Checked, checked
from bench.discrepancy.select.remainder import fitting_best
from bench.discrepancy.select.scatter_size import with_sizes
from bench.discrepancy.select.sealed import unrefused
from bench.discrepancy.select.second_level import beyond_geometry
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
from bench.discrepancy.select.uncounted import with_uncounted
from bench.discrepancy.select.unnamed import curve_words, unnamed, with_mean
from bench.discrepancy.sets import turn as sets
from bench.discrepancy.sets.shifted import beside_faults
from bench.discrepancy.settings import EVIDENCE_ROWS, MARGIN_NATS, MOST_ROUNDS
from bench.discrepancy.with_waveforms import decided, or_without
from bench.discrepancy.working import WorkingRows
from bench.errors import about
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.memory import keep_freed
from bench.physics.simulator import Simulator
from bench.recordings.places import cut_into_places, link_count
from bench.recordings.table import Recordings


@dataclass(frozen=True)
class Options:
    """How much is done: rows used for search, fit and confirmation, the seed, what is compared.

    `measured` and `known` say of columns of the user's own which they are (see `own_columns`).
    `waveform` False simulates from paths alone (see `View`); None decides by the tables: waveforms
    are compared where both sides have them.
    """

    seed: int = 0
    search_rows: int = 2000
    fit_rows: int = 500
    confirm_rows: int = 2000
    hide: tuple[str, ...] = ()
    measured: tuple[str, ...] = ()
    known: tuple[str, ...] = ()
    observables: tuple[str, ...] | None = None
    waveform: bool | None = None


@dataclass(frozen=True)
class Diagnosis:
    """A finished diagnosis; `simulator` has the effects added, None where a table was compared.

    `mix` maps covariates to what differs in their mix (see `TableComparison.mix`); `uncovered` is
    the share of the recorded rows that have no simulated counterpart and took no part; `base` has
    the radio settings that were taken from the recordings. `law` and `setup_fault` are said where
    no known effect explains what is there, and sealed links bear it out. `evidence` has working
    rows to go on from. `measured` are columns of the user's own that were measured with the range,
    so that they were not searched over. `links` counts those of the table, and those after links
    that hold a drive were cut into places (see `bench.recordings.places`). `counted` says how many
    rows each side has, and how many were left out for what.
    """

    source: str
    simulated: str
    selection: Selection
    added: Added
    confirmed: Confirmed
    split: LinkSplit
    simulator: Simulator | None
    mix: dict[str, tuple[float, float]] = field(default_factory=dict)
    options: Options = field(default_factory=Options)
    uncovered: float = 0.0
    base: Base = field(default_factory=Base)
    law: FoundLaw | None = None
    setup_fault: SetupFault | None = None
    evidence: Evidence | None = None
    measured: tuple[str, ...] = ()
    links: tuple[int, int] = (0, 0)
    counted: tuple[str, ...] = ()

    @property
    def recommended(self) -> bool:
        """Whether what was added serves on the sealed links (see `Confirmed.serves`)."""
        return bool(self.added) and self.confirmed.serves

    @property
    def headline(self) -> str:
        """One line to begin with: what was found, and whether the sealed links bear it out."""
        fault = without_a_name(self.setup_fault, self.selection)
        said = fault or self.law or curve_words(self.added)
        more = f"{said}{self.law.nearest if self.law else ''}" if said else ""
        found, added = self.selection, bool(self.added)
        now = NEW_SIMULATOR if self.simulator else NEW_TABLE
        line = headline(found.verdicts, added, self.confirmed, more, found.withheld, now)
        return line + or_elsewhere(found.names, found.elsewhere)


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
    keep_freed()
    asked, journal = decided(options or Options(), recorded, simulated), journal or Journal()
    check_tables(recorded, simulated, bool(asked.waveform))
    numbers = counted(recorded, simulated, options is None or options.waveform is None)
    frame = cut_into_places(whole := hidden(recorded.frame, asked.hide))
    simulated = beside(recorded, simulated)
    measured = measured_columns(frame, asked.measured, asked.known)
    shown = replace(recorded, frame=with_motion(hidden(frame, measured)))
    with about(recorded.source):
        base = base_of(shown.frame, simulated)
    numbers += tried(simulated, base, shown.frame, bool(asked.waveform))
    window = shared_window(shown.frame, getattr(simulated, "frame", None))
    comparison = compared_with(simulated, window, asked.seed, base)
    inside = covered(comparison, shown)
    doubtful = frame[list(doubtful_columns(measured, asked.measured))].iloc[np.flatnonzero(inside)]
    rows = WorkingRows.of(shown.select(inside), asked, doubtful, window)
    every, skipped = library()
    rerun = isinstance(comparison, Resimulation)
    able, lacking = offered(kinds or every, rows.recorded.frame, bool(asked.waveform), rerun)
    skipped |= lacking | text_instead(frame)
    untried = {name: (kinds or every)[name] for name in lacking}
    search = replace(_search(comparison, rows, able, progress), untried=untried)
    journal.know(search.kinds)
    found = select_effects(search, journal)
    if found.mistaken:  # the guess was wrong: what was set aside is known before
        again = replace(asked, known=(*asked.known, *found.mistaken))
        return diagnose(recorded, simulated, again, progress, kinds)
    found = replace(found, skipped={**skipped, **found.skipped})
    weighing = weighed(search, found)
    progress("confirming on links that nothing was tuned on")
    sealed = rows.confirm()
    said = borne_out(comparison, sealed, weighing, asked.seed)
    found, more = said.found, (said.law.effect,) if said.law else unnamed(search, said.found)
    found, kept_more = unrefused(comparison, sealed, found, more, asked.seed)
    law = said.law if more == kept_more else None
    found = found if law else as_it_stands(search, found)
    added = (*found.added, *kept_more)
    confirmed = confirm(untimed(comparison, found.untimed), sealed, added, asked.seed)
    after = comparison.with_effects(added) if isinstance(comparison, Resimulation) else None
    mix = comparison.mix(search.discover) if isinstance(comparison, TableComparison) else {}
    name = simulated.label if isinstance(simulated, Recordings) else simulated.name
    lost = 1 - float(inside.mean())
    kept = evidence(comparison, rows.view(rows.split.work, EVIDENCE_ROWS))
    made = Diagnosis(
        recorded.label, name, found, added, confirmed, rows.split, after, mix, asked, lost, base,
        law, said.fault, kept, measured, (link_count(whole), link_count(frame)), numbers,
    )  # fmt: skip
    alone = replace(asked, waveform=False)  # what is hidden as untrue stays so
    return or_without(made, lambda: diagnose(recorded, simulated, alone, progress, kinds))


def compared_with(
    simulated: Simulator | Recordings, window: Window, seed: int, base: Base
) -> Comparison:
    """Return the counterpart of the recorded rows: a simulator run again, or a table's rows."""
    if isinstance(simulated, Recordings):
        return TableComparison(simulated.frame, window, seed, base)
    return Resimulation(replace(simulated, base=base), window)


def _search(
    comparison: Comparison,
    rows: WorkingRows,
    kinds: Mapping[str, type[Effect]],
    progress: Progress,
) -> Search:
    """Return the search over the working rows; where no waveform is simulated, over all of them."""
    asked = rows.asked
    discover = rows.view(rows.split.discover, asked.search_rows)
    fit = rows.view(rows.split.fit, asked.fit_rows)
    work = None if asked.waveform else rows.view(rows.split.work, asked.search_rows)
    return Search(
        comparison, discover, fit, kinds, asked.seed, progress, work, doubtful=rows.doubtful
    )


def select_effects(search: Search, journal: Journal | None = None) -> Selection:
    """Go round until nothing significant is left, and say what was found.

    Where a column was set aside by mistake, nothing but that is said.
    """
    state, journal, circle = with_logs(State(search)), journal or Journal(), Circle()
    if search.fit.waveform:
        return waves.selected(state, journal)
    if spoilt := state.guard.safely("recorder", spoilt_ranges, None)(state):
        return spoilt
    for turn in journal.rounds(MOST_ROUNDS):
        search.progress(f"searching (round {turn + 1})")
        state = one_round(state, turn, journal)
        if state.search.choice.mistaken:
            return Selection((), (), (), mistaken=state.search.choice.mistaken)
        if state.finished or circle.closed_by(state):
            break
    return concluded(state, journal)


def one_round(state: State, turn: int, journal: Journal) -> State:
    """Locate what is left, explain it, and add what explains it best."""
    kept, safely = journal.kept, state.guard.safely
    state, located = _located(state, turn, journal)
    if not located.significant:
        return last_round(state, located, journal)
    marked = safely("marks", seen_first, state)(state, located)
    if marked is not state:
        return marked
    state, news = sets.agreed(state, located, journal)
    if news:
        return state
    search, added, rest = state.search, state.added, sets.unjudged(state.search)
    explanation = sets.left_to_name(search, kept(explain_left)(rest, added, located))
    explanation = safely("elsewhere", kept(elsewhere_too), explanation)(rest, added, explanation)
    explanation = safely("levels", beyond_geometry, explanation)(rest, added, explanation)
    explanation = safely("order", kept(order), explanation)(rest, added, explanation)
    witness = safely("offsets of links", kept(witnessed_by_links), None)
    best = best_contender(explanation, sets.least_scatter(search))
    best = best or witness(rest, added, explanation)
    struck = safely("links struck at random", kept(strike_links), None)(search, added, best)
    if struck:
        state = state.after(struck_round(located, explanation, struck))
        search = search.spared(struck)
        again = safely("fitting again", kept(polished), added)  # by what was not struck
        return replace(state, search=search, added=again(search.comparison, search.fit, added))
    if best is None:
        return unexplained(state, located, explanation, turn, journal)
    return _with_best(state, located, explanation, best, journal)


def _located(state: State, turn: int, journal: Journal) -> tuple[State, Located]:
    """Return what differs; an effect that this contradicts is taken out first."""
    located = journal.kept(locate_left)(state.search, state.added, turn)
    # A scatter is judged as wide as rows say it is, not as what links keep makes it.
    sized = state.guard.safely("size of scatter", with_sizes, state.added)
    refuted = contradicted(state.search, sized(state.search, state.added), located)
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
    added = with_absorption(search, with_contender(before, best))
    if (len(added) > 1 and not search.choice.names) or search.fit.waveform:
        kept, safely, anew = journal.kept, state.guard.safely, len(added) > 1
        again = safely("fitting again", kept(polished), added)
        added = again(search.comparison, search.fit, added, anew=anew)
        added = safely("curve of levels", with_curve, added)(search, added)
        least = safely("margin", kept(margin), MARGIN_NATS)(search, added)
        added = safely("pruning", kept(prune), added)(search, added, least, best.effect, located)
    if {e.name for e in added} <= {e.name for e in before}:  # what was added was taken out again
        known = best.effect.name in search.kinds
        return replace(state, search=search.without(best.effect), added=added, finished=not known)
    return replace(state, added=added)


def concluded(state: State, journal: Journal) -> Selection:
    """Fit what was chosen once more on all working rows, and say what can be said."""
    search, added, choice = state.search, state.added, state.search.choice
    if search.work is not None and added:
        last = state.guard.safely("last fit", journal.kept(settled), added)
        added = last(beside_faults(search, search.work), search.work, added)
        added = state.guard.safely("size of scatter", with_sizes, added)(search, added)
        added = state.guard.safely("slope of levels", with_slope, added)(search, added)
        added = state.guard.safely("curve of levels", with_curve, added)(search, added)
    search.progress("checking that what was found looks like what was recorded")
    asis = Checked(added, state.rounds)
    held = state.guard.safely("adequacy", journal.kept(checked), asis)(search, state.rounds, added)
    held = state.guard.safely("marks", with_marks, held)(search, held)
    said = journal.kept(verdicts)(search, held.rounds, held.added, held.doubts, held.whole)
    said = with_uncounted(search, held.simulated, of_the_rest(said, held.rounds))
    struck = tuple(turn.strike.effect for turn in held.rounds if turn.strike)
    out = {**state.skipped, **state.guard.failed}
    best = fitting_best(search, held, struck, said)
    found = Selection(said, best, held.rounds, out, choice.names, (), {}, search.logged)
    return with_mean(search, replace(found, tied=choice.tied, elsewhere=choice.elsewhere))
