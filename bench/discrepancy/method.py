"""The method, in the order of a page.

split -> compare -> (locate -> explain -> order -> add -> fit again -> prune) -> verdicts ->
confirm. Each step is a function; `kept(step)` is the same, remembered in a journal for a next run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.untimed import untimed
from bench.discrepancy.compare.view import without
from bench.discrepancy.confirm import confirm
from bench.discrepancy.diagnosis import Diagnosis, Options
from bench.discrepancy.joint import turn as waves
from bench.discrepancy.law.second import with_second
from bench.discrepancy.law.unexplained import borne_out, weighed
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.prepared import Prepared, prepared
from bench.discrepancy.select.backfitting import polished, settled
from bench.discrepancy.select.candidates import Contender, Explanation
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
from bench.discrepancy.select.sealed_class import named_once
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
from bench.discrepancy.select.struck_links import with_struck_links
from bench.discrepancy.select.uncounted import with_uncounted
from bench.discrepancy.select.unlisted import with_edges
from bench.discrepancy.select.unnamed import unnamed, with_mean
from bench.discrepancy.select.unseen import without_unseen
from bench.discrepancy.sets import turn as sets
from bench.discrepancy.sets.shifted import beside_faults
from bench.discrepancy.settings import MARGIN_NATS, MOST_ROUNDS
from bench.discrepancy.with_waveforms import or_without
from bench.physics.effect import Effect
from bench.physics.memory import keep_freed
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings


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
    journal, ready = journal or Journal(), prepared(recorded, simulated, options, kinds)
    search, asked = ready.search(progress), ready.rows.asked
    journal.know(search.kinds)
    found = select_effects(search, journal)
    if found.mistaken:  # the guess was wrong: what was set aside is known before
        again = replace(asked, known=(*asked.known, *found.mistaken))
        return diagnose(recorded, simulated, again, progress, kinds)
    made = confirmed(ready, search, found)
    alone = replace(asked, waveform=False)  # what is hidden as untrue stays so
    return or_without(made, lambda: diagnose(recorded, simulated, alone, progress, kinds))


def confirmed(ready: Prepared, search: Search, found: Selection) -> Diagnosis:
    """Open the sealed links, and say what they bear out and by how much they are fitted better."""
    found = replace(found, skipped={**ready.skipped, **found.skipped})
    comparison, seed, weighing = ready.comparison, search.seed, weighed(search, found)
    search.progress("confirming on links that nothing was tuned on")
    sealed = ready.rows.confirm()
    said = borne_out(comparison, sealed, weighing, seed)
    found, more = said.found, (said.law.effect,) if said.law else unnamed(search, said.found)
    found, kept_more = unrefused(comparison, sealed, found, more, seed)
    law = said.law if more == kept_more else None
    law = with_second(search, comparison, sealed, found, law) if law else None
    found = found if law else as_it_stands(search, found)
    found = found if law or said.fault or kept_more else without_unseen(found)
    around = with_edges(search, named_once(found.verdicts))
    found = with_struck_links(search, replace(found, verdicts=around))
    added = (*found.added, *((law.whole,) if law else kept_more))
    fits = confirm(untimed(comparison, found.untimed), sealed, added, seed)
    return replace(ready.diagnosis(found, added, fits), law=law, setup_fault=said.fault)


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
