"""The part of a search in which waveforms are compared: a set of effects, then ranges beside it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import product

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.skill import tally
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.fit.per_device import fits_itself
from bench.discrepancy.fit.search import Fitted
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.dense import dense_of
from bench.discrepancy.joint.grids import marked_by_grids, with_grids
from bench.discrepancy.joint.late import found_late, holds, moved, with_late
from bench.discrepancy.joint.noisy import without_steady
from bench.discrepancy.joint.own_code import runs_own_code
from bench.discrepancy.joint.rows import compared_rows, fewer
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import SCREEN_ROWS
from bench.discrepancy.joint.strikes import struck_by
from bench.discrepancy.joint.untried import with_unlisted, with_untried
from bench.discrepancy.joint.verdicts import left_by, of_range, wave_verdicts, without_idle
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.all_rows import with_levels, with_ranges, with_waveforms
from bench.discrepancy.select.candidates import Explanation, contender
from bench.discrepancy.select.conclude import struck_out
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.marks import forms_of_marks
from bench.discrepancy.select.odd_device import with_odd_device
from bench.discrepancy.select.own_scatter import beyond_causes
from bench.discrepancy.select.range_part import with_range_part
from bench.discrepancy.select.recorder import recorder_fault, spoilt
from bench.discrepancy.select.refute import Checked
from bench.discrepancy.select.remainder import fitting_best
from bench.discrepancy.select.scatter_alone import scatter_alone
from bench.discrepancy.select.scatter_shape import scatters_alike
from bench.discrepancy.select.settings import WAVES_SHARE
from bench.discrepancy.select.state import Round, Search, Selection, State
from bench.discrepancy.select.stepwise import (
    best_contender,
    explain_left,
    locate_left,
    struck_round,
)
from bench.discrepancy.select.verdict import NoMismatch, Verdict
from bench.discrepancy.settings import SCORE_FIRST, SCORE_MEMBERS
from bench.forked import forking
from bench.physics.effect import Effect
from bench.physics.effects.fitted.pattern_gain import PatternGain
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.receiver.late_detection import LateDetection


def selected(state: State, journal: Journal) -> Selection:
    """Return what waveforms and, beside what these name, ranges speak for."""
    with forking(runs_own_code(state.search)):
        return _selected(state, journal)


def _selected(state: State, journal: Journal) -> Selection:
    """Return `selected`; without a late detection if held-out links fit better without that.

    What was fitted beside it, and took back what it does to ranges, is then asked anew. Rows that
    are late in few links help no link held out: if nothing has a name without it, it keeps its own.
    """
    noise = state.guard.safely("noise of devices", without_steady, state.search)
    state = replace(state, search=noise(state.search))
    found = _as_indices_say(state, journal)
    late = LateDetection.name
    if late not in found.together or late in {one.name for one in found.added}:
        return found
    alone = replace(state, search=state.search.without(LateDetection()))
    other = _as_indices_say(alone, journal)
    return other if other.names else found


def _as_indices_say(state: State, journal: Journal) -> Selection:
    """Return what is selected with a late detection where indices show one."""
    search, kept, safely = state.search, journal.kept, state.guard.safely
    located = _in_all_rows(search, journal, kept(locate_left)(search, (), 0, WAVES_SHARE))
    if not located.significant:
        return _of_sure_ranges(state.after(Round(located, None, None)), journal)
    fault = safely("recorder", recorder_fault, "")(search)
    if fault:
        return spoilt(state.after(Round(located, None, None)), fault)
    search.progress("comparing sets of effects on waveforms")
    late = safely("indices of first paths", kept(beside_late), None)(search)
    if late:
        search, choice = late
        state = replace(state, search=search)
    else:
        choice = safely("sets of waveform effects", kept(chosen), WaveChoice())(search)
    found = safely("links struck at random", kept(struck_by), None)(search, choice)
    if found:
        state, located, choice = _spared(state, journal, found, located)
        search = state.search
    state = replace(state, added=choice.added)
    rounds = safely("rounds", kept(rounds_of), ())(search, choice, located)
    state = replace(state, rounds=(*state.rounds, *(rounds or (Round(located, None, None),))))
    elsewhere = safely("places of first paths", kept(moved), False)(search, choice)
    state = with_range_part(state, journal, choice.unlisted or elsewhere)
    if state.search.choice.mistaken:
        return Selection((), (), (), mistaken=state.search.choice.mistaken)
    state = safely("grid of ranges", with_grids, state)(state)
    state = safely("scatter", with_scatter, state)(state, journal, choice)
    return _said(_with_last(state, journal), choice, journal)


def _of_sure_ranges(state: State, journal: Journal) -> Selection:
    """Return what ranges speak for beyond doubt where no search found anything."""
    sure = with_range_part(state, journal)
    if sure.search.choice.mistaken:
        return Selection((), (), (), mistaken=sure.search.choice.mistaken)
    sure = sure.guard.safely("grid of ranges", with_grids, sure)(sure)
    return _said(_with_last(sure, journal) if sure.added else sure, WaveChoice(), journal)


def _spared(
    state: State, journal: Journal, found: Strike, located: Located
) -> tuple[State, Located, WaveChoice]:
    """Return the state without the links that were struck, what differs there, and its set."""
    safely, kept = state.guard.safely, journal.kept
    differs = kept(left_by)(state.search, (), located)
    after = state.after(struck_round(located, differs, found))
    after = replace(after, search=state.search.spared(found))
    left = kept(locate_left)(after.search, (), 1)
    if not left.significant:
        return after, left, WaveChoice()
    again = safely("sets of waveform effects", kept(chosen), WaveChoice())(after.search, True)
    return after, left, again


def chosen(search: Search, struck: bool = False) -> WaveChoice:
    """Return the set of effects that waveforms of all working rows speak for.

    `struck`: some other links were struck at random.
    """
    kinds = [
        in_waveforms(kind, search)
        for kind in search.kinds.values()
        if kind.stage != "ranging" and not fits_itself(kind) and kind.strikes is None
    ]
    tries = [tuple(forms) for forms in product(*forms_of_marks(search))]
    rows = compared_rows(search)
    few = fewer(search.fit, SCREEN_ROWS)
    sets = Sets(search.comparison, rows, few, kinds, tries, struck)
    choice = sets.chosen()
    return replace(choice, dense=dense_of(sets.grain, choice.added, search.untried))


def in_waveforms(kind: type[Effect], search: Search) -> type[Effect]:
    """Return the kind that says of waveforms what an effect does to them: of a pattern its gain.

    What comes from the first path on does not show how late that is: of ranges, a delay that
    waveforms chose would be whatever the search began with.
    """
    able = kind is AntennaPattern and not PatternGain.lacking(search.fit.frame.columns)
    return PatternGain if able else kind


def beside_late(search: Search) -> tuple[Search, WaveChoice] | None:
    """Return the search and its set with a late detection, None where indices show none."""
    late = found_late(search)
    if late is None:
        return None
    marked = replace(search, logged=(*search.logged, late))
    choice = chosen(marked)
    return (marked, with_late(search, late, choice)) if holds(search, late, choice) else None


def rounds_of(search: Search, choice: WaveChoice, located: Located) -> tuple[Round, ...]:
    """Return one round for every effect of the set, with those that would do as well."""
    return tuple(
        Round(located, _explained(search, choice.added, effect, choice.rivals), effect)
        for effect in choice.added
    )


def _explained(
    search: Search, added: Added, effect: Effect, rivals: dict[str, Added]
) -> Explanation:
    """Return what one effect of a set and its rivals gain beside the others on held-out links."""
    mine = next(one for one in added if one is effect)
    rest = without(added, mine)
    reference = tally(search.comparison.ensemble(search.discover, rest, SCORE_MEMBERS, SCORE_FIRST))
    made = tuple(
        contender(search.comparison, search.discover, rest, Fitted(e, 0.0, 0), reference, 0)
        for e in (mine, *rivals.get(mine.name, ()))
    )
    return Explanation(made, reference, made[0].gain, made[0].tally, {}, {})


def with_scatter(state: State, journal: Journal, choice: WaveChoice) -> State:
    """Return the state with scatter of the ranges, where that is what is left of them.

    Not beside what makes detected first paths jump: how far is for a detector nobody knows to say.
    Nor beside what no effect explains: it may scatter ranges too.
    """
    search = state.search
    if choice.unlisted or any(type(effect).jumps for effect in state.added):
        return state
    left = _left_beside(search, state.added, len(state.rounds), journal)
    if not any(map(of_range, left.findings)):
        return state
    kinds = {n: k for n, k in search.kinds.items() if k.independent or k.marked}
    found = journal.kept(explain_left)(replace(search, kinds=kinds), state.added, left)
    able = tuple(one for one in found.contenders if one.effect.name in kinds)
    found = replace(found, contenders=able)
    best = best_contender(found)
    if best is None:
        return _with_rows_scatter(state, found, left)
    added = (*state.added, best.effect)
    if not _scatters_by_itself(search, added, best.effect):
        # As wide as a score has it, which takes what links keep for it; not as wide as rows do.
        return _with_rows_scatter(state, found, left)
    turn = Round(left, found.led_by(best), best.effect)
    return replace(state, added=added, rounds=(*state.rounds, turn))


def _with_rows_scatter(state: State, found: Explanation, left: Located) -> State:
    """Return the state with scatter that rows of links show where no score does.

    A score of one simulated row hardly falls where scatter is added to it. What differs in
    waveforms was judged with their set, and is no scatter of ranges.
    """
    ranged = replace(state.search, work=state.search.both)
    seen = replace(left, findings=tuple(filter(of_range, left.findings)))
    ask = state.guard.safely("scatter alone", scatter_alone, None)
    scatter = ask(ranged, state.added, found, seen)
    return state.after(struck_round(left, found, scatter)) if scatter else state


def _scattered(state: State) -> Added:
    """Return scatter that rows of links show: it strikes all rows, and spares none."""
    strikes = (turn.strike.effect for turn in state.rounds if turn.strike)
    return tuple(effect for effect in strikes if type(effect).independent)


def _scatters_by_itself(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether ranges scatter as that effect does, and not as another cause makes them."""
    rows = search.both
    alike = scatters_alike(search.comparison, rows, added, effect)
    return alike.adequate and beyond_causes(replace(search, work=rows), added, effect).adequate


def _with_last(state: State, journal: Journal) -> State:
    """Return the state with a last round: what is left, and how much of it could be removed."""
    search, added = state.search, (*state.added, *_scattered(state))
    left = _left_beside(search, added, len(state.rounds) + 1, journal)
    last = Round(left, None, None)
    if left.significant and (not added or any(of_range(found) for found in left.findings)):
        last = replace(last, explanation=journal.kept(left_by)(search, added, left))
    old = tuple(turn for turn in state.rounds if turn.added is not None)
    first = state.rounds[0].located
    return replace(state, rounds=(*(old or (Round(first, last.explanation, None),)), last))


def _left_beside(search: Search, added: Added, step: int, journal: Journal) -> Located:
    """Return what effects leave; where there is none, what all working rows show."""
    left = journal.kept(locate_left)(search, added, step)
    return left if added else _in_all_rows(search, journal, left)


def _in_all_rows(search: Search, journal: Journal, found: Located) -> Located:
    """Return what waveforms of half the rows show, or of all, or their ranges, or their levels.

    Or those of one device.
    """
    for step in (with_waveforms, with_ranges, with_levels, with_odd_device):
        found = journal.kept(step)(search, found)
    return found


def _said(state: State, choice: WaveChoice, journal: Journal) -> Selection:
    """Return the selection with its verdicts, and the simulator that fits best."""
    search, rounds, choice = state.search, state.rounds, marked_by_grids(choice, state)
    said = journal.kept(wave_verdicts)(search, rounds, state.added, choice)
    with_more = state.guard.safely("untried effects", with_untried, said)
    said = with_more(search, state.added, said, choice.dense)
    struck = tuple(turn.strike for turn in rounds if turn.strike)
    names = [_struck(state, turn, turn.strike) for turn in rounds if turn.strike]
    said = (*names, *(one for one in said if not (names and isinstance(one, NoMismatch))))
    held = Checked(state.added, rounds)
    likely = set(choice.nats) - set(choice.marked)
    best = fitting_best(search, held, tuple(one.effect for one in struck), said, likely)
    told = {*choice.marked, *(one.name for one in (*search.logged, *(s.effect for s in struck)))}
    left = partial(journal.kept(locate_left), search, best, len(rounds) + 1)
    said = without_idle(said, rounds, best, told, set(choice.nats), left)
    skipped = {**state.skipped, **state.guard.failed}
    together = tuple(effect.physics for effect in state.added)
    tied, places = search.choice.tied, search.choice.elsewhere
    return Selection(said, best, rounds, skipped, together, tied=tied, elsewhere=places)


def _struck(state: State, turn: Round, found: Strike) -> Verdict:
    """Return the verdict on what strikes links or, where it is scatter, every row."""
    search, every = state.search, (*state.added, *_scattered(state))
    said = struck_out(search, turn, found, state.added)
    if found.effect in every:
        return with_untried(search, every, (said,))[0]
    return with_unlisted(search, said)
