"""What a finished search says: verdicts, each name with its intervals and negative control."""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.skill import Tally, fall, gain_interval, tally
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.doubt import with_doubt
from bench.discrepancy.fit.sandwich import Intervals, parameter_intervals
from bench.discrepancy.select.as_likely import over_forms
from bench.discrepancy.select.backfitting import rivals
from bench.discrepancy.select.candidates import Explanation, equivalents, nearly_as_good
from bench.discrepancy.select.controls import negative_control, struck_control
from bench.discrepancy.select.disguise import without_disguises
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.left_by_names import left_by_names
from bench.discrepancy.select.link_mixture import Strike, apart
from bench.discrepancy.select.logged import judged_by, read_off
from bench.discrepancy.select.objections import objection
from bench.discrepancy.select.one_device import left_at_device
from bench.discrepancy.select.own_scatter import OF_SCATTER
from bench.discrepancy.select.refute import Doubt
from bench.discrepancy.select.separate import one_of
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import bears_mark, versions
from bench.discrepancy.select.told_by import told_otherwise
from bench.discrepancy.select.unlisted import with_walls
from bench.discrepancy.select.verdict import (
    Control,
    LeftOut,
    NoMismatch,
    Unknown,
    Verdict,
    options_of,
)
from bench.discrepancy.select.within_links import rows_beyond
from bench.discrepancy.sets.constant_in import in_words
from bench.discrepancy.sets.settings import LEFT_SHARE
from bench.discrepancy.sets.shifted import beside_faults
from bench.discrepancy.settings import (
    FORM_REACHED,
    MARGIN_NATS,
    MOST_ALTERNATIVES,
    OFFSET_NATS,
    REMOVED_SHARE,
    ROWS_BEYOND,
    SCORE_FIRST,
    SCORE_MEMBERS,
    SURE_P,
)
from bench.physics.effect import Effect


def verdicts(
    search: Search,
    rounds: tuple[Round, ...],
    added: Added,
    doubts: tuple[Doubt, ...] = (),
    whole: Added = (),
) -> tuple[Verdict, ...]:
    """Return what can be said: names that hold, and what is left, `doubts` among it.

    `added` may be named; `whole` are all effects beside which they were judged, () for the same.
    """
    last = rounds[-1]
    beside = whole or added
    strikes = (struck_out(search, turn, turn.strike, beside) for turn in rounds if turn.strike)
    struck = tuple(with_walls(search, one) for one in strikes)
    if doubts:
        held = verdicts(search, rounds, added, whole=whole) if added else struck
        known = tuple(v for v in held if not isinstance(v, Unknown))
        if known and _within_forms(search, _share(search, _since_struck(rounds), added)):
            return known
        return (*known, _doubted(rounds, doubts))
    if not added and not real(search, last):
        return struck or (NoMismatch(last.located.detectable, last.located.p),)
    share = _share(search, _since_struck(rounds), added)
    unexplained = last.located.significant and last.added is None
    removable = last.explanation.removable if last.explanation else Estimate(0, 0, 0)
    least = _form_leaves(search, added)
    worth = unexplained and removable.above_zero and removable.value > least
    worth = worth or (not added and not last.strike and real(search, last))
    worth = worth and not left_by_names(search, added, last)
    if worth and share < REMOVED_SHARE and (search.fit.waveform or not search.choice.names):
        seen = _marked(search, _named(search, rounds, added, whole or added, share))
        little = in_words(search.choice) or "the best known effects remove too little of it"
        return (*struck, *seen, _unknown(last, little))
    named = (*struck, *_named(search, rounds, added, whole or added, share))
    worth = worth and not (added and _within_forms(search, share))
    if unexplained and added and last.explanation and not search.fit.waveform:
        at_device = left_at_device(last.located.findings)
        worth = worth or bool(at_device or search.choice.faults)
    return (*named, _unknown(last, _why_left(search, last, named))) if worth else named


def _why_left(search: Search, last: Round, named: tuple[Verdict, ...]) -> str:
    """Return the words for what is left: beside names, or alone."""
    if any(verdict.names for verdict in named):
        return "left after the named effects"
    if following := in_words(search.choice):
        return following
    findings = [one.told for one in last.located.findings]
    first = next(iter(findings), None)
    wide = first and first.cell.observable == RANGE and first.cell.moment in OF_SCATTER
    if first and wide and first.effect.high < 0:
        return "simulated ranges scatter more than recorded ones, and no effect takes scatter away"
    return "no known effect removes enough of it"


def of_the_rest(said: tuple[Verdict, ...], rounds: tuple[Round, ...]) -> tuple[Verdict, ...]:
    """Return the verdicts; what is unknown beside names is what these leave.

    Causes of one set share the search before all of them.
    """
    left = rounds[-1].located.findings
    if not left or not any(verdict.names for verdict in said):
        return said
    return tuple(replace(v, findings=left) if isinstance(v, Unknown) else v for v in said)


def _marked(search: Search, named: tuple[Verdict, ...]) -> tuple[Verdict, ...]:
    """Return the names whose mark recorded rows bear: they are there, whatever they remove."""
    first = ((verdict, one) for verdict in named for one in options_of(verdict)[:1])
    return tuple(verdict for verdict, one in first if bears_mark(search, one.effect))


def _within_forms(search: Search, share: float) -> bool:
    """Return whether what names leave of a mismatch is what another form of them would leave.

    With waveforms, where hundreds of figures are compared, such a rest is always significant.
    """
    return search.fit.waveform and share >= FORM_REACHED


def _since_struck(rounds: tuple[Round, ...]) -> Explanation:
    """Return the first explanation on the links that are judged at the end."""
    start = max((i + 1 for i, turn in enumerate(rounds) if turn.strike), default=0)
    return next(turn.explanation for turn in (*rounds[start:], *rounds) if turn.explanation)


def struck_out(search: Search, turn: Round, found: Strike, added: Added) -> Verdict:
    """Return the verdict on an effect that strikes links at random, or on some that do as well.

    One that is there too where it must do nothing is no name.
    """
    options = [_struck_option(search, turn, one, added) for one in (found, *found.others)]
    passed = tuple(one for one in options if one.control.passed is not False)
    if options[0] not in passed:
        words = options[0].control.words
        note = f"{found.effect.physics} gains most, but it is there too in {words}"
        return _refuted(turn, note)
    return of_class(turn, passed, search.fit.waveform)


def _struck_option(search: Search, turn: Round, found: Strike, added: Added) -> LeftOut:
    """Return what can be said of one effect that strikes links at random."""
    unknown = Control(type(found.effect).control, None)
    control = Guard().safely("negative control", struck_control, unknown)(
        search, added, found.effect
    )
    return LeftOut(
        found.effect,
        found.parameters,
        found.evidence,
        1.0,
        control,
        turn.located.findings,
        judged=found.judged,
    )


def real(search: Search, last: Round) -> bool:
    """Return whether a located mismatch holds up where nothing was added.

    Something can be removed on held-out links, or the search leaves no doubt by itself, or links
    have offsets of their own, or rows lie beyond all simulated ones (which are there although
    nothing predicts them).
    """
    if not last.located.significant or last.explanation is None:
        return False
    if last.explanation.removable.above_zero or last.located.p <= SURE_P:
        return True
    if search.work is None:
        return False
    if apart(search.comparison, search.work, ()) > OFFSET_NATS:
        return True
    made = versions(search.comparison, search.work, ())
    return RANGE in made.names and rows_beyond(made) >= ROWS_BEYOND


def _unknown(last: Round, note: str) -> Unknown:
    """Return the verdict on what no effect explains."""
    assert last.explanation is not None
    tried = {c.name: c.gain.value for c in last.explanation.contenders}
    return Unknown(last.located.findings, last.explanation.removable, tried, note)


def _doubted(rounds: tuple[Round, ...], doubts: tuple[Doubt, ...]) -> Unknown:
    """Return the verdict where names that gained most do not reproduce what they act on."""
    names = {doubt.effect.name for doubt in doubts}
    turns = [turn for turn in rounds if turn.added and turn.added.name in names]
    turn = next(turn for turn in (*turns, *rounds) if turn.explanation)
    return replace(_unknown(turn, ""), note="; ".join(map(str, doubts)))


def _share(search: Search, first: Explanation, added: Added) -> float:
    """Return the gain of all added effects as a fraction of the flexible regression's.

    With waveforms, of the fall of the scores: there a count that hardly scatters lets a regression
    gain nats for the last thousandth of a mismatch.
    """
    if not added:
        return 0.0
    before, after = _beside(search, added)
    if search.fit.waveform:
        reached, most = fall(before, after), fall(first.base, first.nuisance)
    else:
        reached, most = gain_interval(before, after, search.seed).value, first.removable.value
    return float(reached / max(most, reached, 1e-9))


def _beside(search: Search, added: Added) -> tuple[Tally, Tally]:
    """Return the tallies without and with the effects."""
    before, after = (
        tally(search.comparison.ensemble(search.discover, effects, SCORE_MEMBERS, SCORE_FIRST))
        for effects in ((), added)
    )
    return before, after


def _form_leaves(search: Search, added: Added) -> float:
    """Return the nats that effects fitted may leave: parameters are only known so well.

    Of a set of causes, their forms too.
    """
    if not added:
        return 0.0
    if not search.choice.names:
        return MARGIN_NATS
    reached = gain_interval(*_beside(search, added), search.seed).value
    return max(MARGIN_NATS, LEFT_SHARE * reached)


def _named(
    search: Search, rounds: tuple[Round, ...], added: Added, whole: Added, share: float
) -> tuple[Verdict, ...]:
    """Return one verdict per added effect: named alone, or with those that do as well.

    Each is judged as it is beside all others of `whole`.
    """
    out: list[Verdict] = []
    names = {effect.name for effect in added}
    for turn in rounds:
        if turn.added is None or turn.explanation is None or turn.strike:
            continue
        effect = next((e for e in whole if e.name == turn.added.name), None)
        if (
            effect is None
            or effect.name not in names
            or any(effect.physics in v.names for v in out)
        ):
            continue
        together = effect.physics in search.choice.names
        same = turn.explanation.contenders
        if not together:
            same = equivalents(turn.explanation, search.seed)
        if search.fit.waveform:
            same = (*same, *nearly_as_good(turn.explanation, same))
        if len(whole) > 1 and not together:
            views = (search.fit, search.discover)
            held = rivals(
                search.comparison, views, whole, effect, same[1:], search.kinds, search.seed
            )
            same = (same[0], *held)
        options = tuple(
            left_out(
                search, turn, effect if i == 0 else c.effect, c.gain, c.company[:-1] or whole, share
            )
            for i, c in enumerate(same)
        )
        objections = [objection(search, turn, whole, effect, option) for option in options]
        passed = tuple(o for o, why in zip(options, objections, strict=True) if not why)
        passed = without_disguises(gaining(passed, options[0]), search.searched)
        if not passed:  # a name whose own negative control fails is none
            out.append(_refuted(turn, objections[0]))
        else:
            out.append(of_class(turn, passed, search.fit.waveform))
    return tuple(out)


def gaining(passed: tuple[LeftOut, ...], first: LeftOut) -> tuple[LeftOut, ...]:
    """Return the options that hold: without the first, which is refused, those that gain for sure.

    What does as well as a name that is refused is no better known than that: it must gain by
    itself, as what comes in the place of a refused effect must elsewhere (see `refute`).
    """
    return passed if first in passed else tuple(o for o in passed if o.gain.likely_above_zero)


def of_class(turn: Round, options: tuple[LeftOut, ...], waveform: bool) -> Verdict:
    """Return the verdict on one name, or on some of which each would do.

    With waveforms unknown where they are many. Ranges alone leave as many open as there are
    settings that never vary.
    """
    if waveform and len(options) > MOST_ALTERNATIVES:
        words = ", ".join(option.names[0] for option in options)
        return _refuted(turn, f"looks like any of {words}, so like none of them")
    return one_of(options)


def _refuted(turn: Round, note: str) -> Unknown:
    """Return the verdict where what gained most is no name."""
    assert turn.explanation is not None
    tried = {c.name: c.gain.value for c in turn.explanation.contenders}
    return Unknown(turn.located.findings, turn.explanation.removable, tried, note)


def left_out(
    search: Search,
    turn: Round,
    effect: Effect,
    gain: Estimate,
    added: Added,
    share: float,
    intervals_of: Intervals = parameter_intervals,
) -> LeftOut:
    """Return a named effect with its intervals and negative control."""
    others = without(added, turn.added) if turn.added else added
    guard = Guard()
    sizes = guard.safely("intervals", intervals_of, ())
    view = search.fitted_on(effect)
    comparison = beside_faults(search, view)
    fitted = over_forms(sizes, comparison, view, others, effect)
    intervals = told_otherwise(search, others, effect, fitted)
    if effect.physics in search.choice.unsure:
        doubted = guard.safely("what else it may do", with_doubt, intervals)
        unsure = search.choice.unsure[effect.physics]
        intervals = doubted(comparison, view, others, effect, intervals, unsure)
    known = guard.safely("value in a log", read_off, ())(search, effect)
    intervals = (*known, *(o for o in intervals if o.name not in {one.name for one in known}))
    unknown = Control(type(effect).control, None)
    test = guard.safely("negative control", negative_control, unknown)
    top = turn.located.findings[:1]  # none where a mark alone speaks for it
    control = test(search, others, effect, top[0]) if top else unknown
    found = LeftOut(effect, intervals, gain, share, control, turn.located.findings)
    return replace(found, judged=judged_by(search, effect) or found.judged)
