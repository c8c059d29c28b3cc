"""What a comparison of waveforms says: names of the set, of ranges beside it, and what is left."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import Added, Comparison, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.sandwich import Intervals, parameter_intervals
from bench.discrepancy.joint.at_null import needed, surely_there
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.plainer import without_waves
from bench.discrepancy.joint.settings import LOUDER
from bench.discrepancy.joint.sizes import sizes_seen
from bench.discrepancy.joint.tone_or_noise import counterparts
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.select.adequacy import adequacy
from bench.discrepancy.select.candidates import Explanation, regressed
from bench.discrepancy.select.conclude import left_out, of_class, real
from bench.discrepancy.select.constant_level import level_apart
from bench.discrepancy.select.disguise import without_disguises
from bench.discrepancy.select.essentials import idle, unused
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.other_forms import made_by_forms
from bench.discrepancy.select.refute import swapped_for
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import locate_left
from bench.discrepancy.select.undetermined import hardly_more, taken_away, untold
from bench.discrepancy.select.verdict import LeftOut, NoMismatch, Unknown, Verdict, options_of
from bench.discrepancy.sets.choice import MERE
from bench.discrepancy.sets.set_up import is_fault
from bench.discrepancy.settings import MARGIN_NATS, SCORE_FIRST, SCORE_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.quantisation import OnGrid

LEFT_OF_WAVES = "all known effects together leave a part that none of them explains"
LEFT_OF_RANGES = "left after the named effects"
NOTHING_NAMED = "no known effect explains enough of it to be named"
CONSTANT = (
    "ranges are off by the same few centimetres everywhere: antennas, covers, films and detectors "
    "make that alike; a calibration takes it off"
)


def left_by(search: Search, added: Added, located: Located) -> Explanation:
    """Return what a flexible regression removes of what effects leave on held-out links.

    Of ranges alone where these differ: what is left of waveforms was judged with their set.
    """
    focus = tuple(dict.fromkeys(found.cell.observable for found in located.findings))
    names = (RANGE,) if RANGE in focus else focus
    before = tally(search.comparison.ensemble(search.discover, added, SCORE_MEMBERS, SCORE_FIRST))
    after = tally(regressed(search.comparison, search.fit, search.discover, added, names))
    removable = gain_interval(before, after, search.seed, names)
    return Explanation((), before, removable, after, {}, {})


def wave_verdicts(
    search: Search, rounds: tuple[Round, ...], added: Added, choice: WaveChoice
) -> tuple[Verdict, ...]:
    """Return what can be said: every name with its intervals, and what is left without a name."""
    last = rounds[-1]
    if not added and not _more(search, rounds):
        return (NoMismatch(last.located.detectable, last.located.p),)
    quiet = {effect.name for effect in choice.quiet}
    turns = [turn for turn in rounds if _named(turn) not in {"", *quiet}]
    able = Guard().safely("sizes of waveform effects", sizes_seen, parameter_intervals)
    sizes = able(search) if turns else parameter_intervals
    said = {t.added.name: _said(search, t, added, choice, sizes) for t in turns if t.added}
    named = standing({name: one for name, one in said.items() if one is not None}, choice)
    if choice.unlisted:
        why = choice.likeness(_worse(rounds)) + LEFT_OF_WAVES
        left = _unknown(rounds[0], last, why, added)
        return seen_beside(search, (*named, left), added, rounds)
    if not any(one.names for one in named) or _more_in_ranges(search, last):
        refused = [one.note for one in named if isinstance(one, Unknown)]
        refused += [CONSTANT] if MERE in search.choice.others else []
        named = tuple(one for one in named if one.names)
        why = LEFT_OF_RANGES if named else (*refused, NOTHING_NAMED)[0]
        named = (*named, _unknown(rounds[0], last, why, added))
    return seen_beside(search, named, added, rounds)


def _worse(rounds: tuple[Round, ...]) -> set[str]:
    """Return the names of effects that make held-out links surely worse."""
    tried = [one for turn in rounds if turn.explanation for one in turn.explanation.contenders]
    return {one.name for one in tried if one.gain.high < 0}


def seen_beside(
    search: Search, said: tuple[Verdict, ...], added: Added, rounds: tuple[Round, ...]
) -> tuple[Verdict, ...]:
    """Return verdicts without what has no name where a search finds nothing beside the names.

    A likelihood of many statistics may ask for more than is there, or for a little of what is then
    refused: something without a name must be found in all working rows as everything else is, or
    be a cause that ranges speak for. Nor is it what other forms of names make (`made_by_forms`).
    """
    names = {name for one in said for name in one.names[:1]}
    held = tuple(effect for effect in added if effect.physics in names)
    if not held or not any(isinstance(one, Unknown) for one in said):
        return said
    whole, last = replace(search, work=search.both), rounds[-1]
    left = locate_left(whole, held, len(rounds) + 1)
    if left.findings and all(o.cell.observable in _logs_of(held) for o in left.findings):
        return _names_of(said)
    if not all(map(of_range, left.findings)):
        return said
    asked = left.significant or search.choice.others
    if asked and not made_by_forms(search, held, last):
        return said
    return _names_of(said)


def _logs_of(held: Added) -> set[str]:
    """Return what receivers log of effects: that is of another size elsewhere is its form."""
    return {type(effect).logged_as for effect in held} - {""}


def _names_of(said: tuple[Verdict, ...]) -> tuple[Verdict, ...]:
    return tuple(one for one in said if not isinstance(one, Unknown))


def _more_in_ranges(search: Search, last: Round) -> bool:
    """Return whether ranges show what nothing named explains.

    They do where sets of their causes have a fault of the set-up, such as a device that stands
    elsewhere instead of a name it does as well as.
    """
    left = _ranges_left(last) and not search.choice.forms_do
    return left or _faulty(search)


def _faulty(search: Search) -> bool:
    """Return whether what ranges speak for is a fault of the set-up."""
    found = search.choice
    return any(map(is_fault, found.others)) or bool(found.tied and not found.names)


def without_idle(
    said: tuple[Verdict, ...],
    rounds: tuple[Round, ...],
    best: Added,
    sure: Collection[str],
    waves: Collection[str],
    left: Callable[[], Located],
) -> tuple[Verdict, ...]:
    """Return verdicts without names that held-out links need neither in score nor in simulator.

    `best` is the simulator that fits best, `sure` the names that bear a mark or a log shows,
    `waves` those that waveforms speak for: scatter that only ranges show was seen beside all names,
    and goes with one of them. `left` searches for what `best` leaves: beside other names something
    without one is there only where that finds anything.
    """
    kept = {effect.physics for effect in best} | set(sure)
    named = [one for one in said if one.names and not kept & {*one.names}]
    idle = [one for one in named if not _likely(one)]
    stay = tuple(one for one in said if one not in idle)
    if idle:
        stay = tuple(one for one in stay if not _scatters_beside(one, {*sure, *waves}))
    if not idle or any(isinstance(one, Unknown) for one in stay):
        return stay
    names = " and ".join(one.names[0] for one in idle)
    why = f"looks most like {names}, but held-out links are no better with it"
    if not any(one.names for one in stay):
        return (*stay, _unknown(rounds[0], rounds[-1], why))
    last = replace(rounds[-1], located=left())
    return (*stay, _unknown(last, last, why, best)) if last.located.significant else stay


def _likely(said: Verdict) -> bool:
    """Return whether held-out links are likely better with an effect, or with one of a class."""
    return any(one.gain.likely_above_zero for one in options_of(said))


def _scatters_beside(said: Verdict, but: Collection[str]) -> bool:
    """Return whether a verdict names scatter that only ranges show, none of those in `but`."""
    leads = options_of(said)[:1]  # the first leads its class
    return any(type(one.effect).independent and one.names[0] not in but for one in leads)


def _more(search: Search, rounds: tuple[Round, ...]) -> bool:
    """Return whether something is there, beside links that were struck where some were.

    One that was struck and not told from the others leaves an offset that nothing predicts. A fault
    of the set-up or a constant that the set of ranges holds is there, whether or not a regression
    foretells it.
    """
    last = rounds[-1]
    if _faulty(search) or MERE in search.choice.others:
        return True
    if not any(turn.strike for turn in rounds):
        return real(search, last)
    removable = last.explanation.removable if last.explanation else Estimate(0, 0, 0)
    return removable.above_zero and removable.value > MARGIN_NATS


def _named(turn: Round) -> str:
    """Return the name of what a round added, "" where nothing, or what strikes links."""
    return turn.added.name if turn.added and not turn.strike else ""


def standing(said: dict[str, Verdict], choice: WaveChoice) -> tuple[Verdict, ...]:
    """Return the verdicts without names that may only mend the form of one that is refused.

    Of waveforms: those that bring not much more than it does, do no more than it where they act,
    and bear no mark; and a noise floor beside a refused tone, or a tone beside such a noise.
    """
    refused = [name for name, one in said.items() if not one.names and name in choice.nats]
    return tuple(
        one for name, one in said.items() if not one.names or _stands(name, refused, choice)
    )


def _stands(name: str, refused: list[str], choice: WaveChoice) -> bool:
    """Return whether a name is more than what may mend the form of those that are refused."""
    twins = {o.name for e in choice.added if e.name == name for o in counterparts(e)}
    if twins.intersection(refused):
        return False
    mended = [choice.nats[one] for one in refused if one not in choice.beyond.get(name, ())]
    loud = choice.nats.get(name, np.inf) >= LOUDER * max(mended, default=0.0)
    return name in choice.marked or bool(loud)


def of_range(found: Finding) -> bool:
    """Return whether a finding is of the ranges."""
    return found.cell.observable == RANGE


def _ranges_left(last: Round) -> bool:
    """Return whether a regression removes something of what is left of the ranges."""
    if last.explanation is None or not any(map(of_range, last.located.findings)):
        return False
    removable = last.explanation.removable
    return removable.above_zero and removable.value > MARGIN_NATS


def _said(
    search: Search, turn: Round, added: Added, choice: WaveChoice, sizes: Intervals
) -> Verdict | None:
    """Return the verdict on what a round added, None where that is no more among the effects.

    Where the first of a class is refused, what would do as well is none either.
    """
    effect = next((e for e in added if turn.added and e.name == turn.added.name), None)
    if effect is None or turn.explanation is None:
        return None
    options = [
        left_out(search, turn, effect if place == 0 else one.effect, one.gain, added, 1.0, sizes)
        for place, one in enumerate(turn.explanation.contenders[: _alike(turn, effect)])
    ]
    check = Guard().safely("objection", _objection, "")
    why = [check(search, swapped_for(added, effect, o.effect), o, effect, choice) for o in options]
    why = beside_untold(search.comparison, effect, [one.effect for one in options], why)
    passed = tuple(one for one, words in zip(options, why, strict=True) if not words)
    passed = without_disguises(passed, search.searched)
    if effect.name in choice.marked:
        return options[0]
    if why[0] or not passed:
        return _unknown(turn, turn, f"looks most like {effect.physics}, but {why[0]}")
    return of_class(turn, passed, True)


def _objection(
    search: Search, added: Added, option: LeftOut, first: Effect, choice: WaveChoice
) -> str:
    """Return in words why an effect is no name in the place of the `first`, "" where it may be.

    Where that makes links scatter, and has nothing more that it must do, it must look like
    recordings wherever one looks: scatter stands for whatever is not predicted. Not where a log or
    samples of noise alone show it, which also tell it from none, whatever its intervals hold.
    """
    shown = first.name in choice.shown
    if option.control.passed is False:
        return f"it is there too in {option.control.words}"
    if untold(option) and not shown and not surely_there(search, added, option.effect):
        return "none of its values is told from zero"
    words = unused(option.effect) or _idle(search, added, option)
    rounded = any(isinstance(one, OnGrid) for one in added)
    if words := words or taken_away(option.effect) or hardly_more(option, rounded):
        return words
    if option.effect.name != first.name and (words := without_waves(option)):
        return words
    wider = first.name in choice.scattering and not shown
    if not wider or type(option.effect).essential:
        return ""
    found = adequacy(search.comparison, (search.fit, search.discover), added, option.effect)
    return "" if found.adequate else found.words


def beside_untold(
    comparison: Comparison, effect: Effect, options: Sequence[Effect], why: Sequence[str]
) -> list[str]:
    """Return the objections to options; those to `effect` for what is not told from it by a log.

    They ask what is logged of noise, too, and another tool may log its power or its scatter: what
    it may be of neither tone nor noise floor is no objection to one of them alone.
    """
    asked = isinstance(comparison, Resimulation)
    twins = set() if asked else {one.name for one in counterparts(effect)}
    return [why[0] if o.name in twins else words for o, words in zip(options, why, strict=True)]


def _idle(search: Search, added: Added, option: LeftOut) -> str:
    """Return what is wrong with an essential parameter, in words, "" where nothing is.

    Of one whose interval holds nothing it is asked what the set is without it.
    """
    kind = type(option.effect)
    wanted = {p.name: p for p in kind.parameters() if p.name in kind.essential}
    for one in (found for found in option.parameters if found.name in wanted):
        words = idle(wanted[one.name], one)
        if words and needed(search, added, option.effect, one.name):
            words = idle(wanted[one.name], one, needed=True)
        if words and isinstance(option.effect, PathLoss):  # what is left of it is a level
            rest = without(added, option.effect)
            words = level_apart(search.comparison, search.searched, rest) or words
        if words:
            return words
    return ""


def _alike(turn: Round, effect: Effect) -> int:
    """Return how many contenders of a round are one class: of scatter, the first alone."""
    assert turn.explanation is not None
    return 1 if type(effect).independent else len(turn.explanation.contenders)


def _unknown(first: Round, last: Round, note: str, added: Added = ()) -> Unknown:
    """Return the verdict on what no effect explains, with what differs beside those `added`."""
    seen = last if last.located.significant else first
    beside = tuple(effect.physics for effect in added) if seen is last else ()
    removable = seen.explanation.removable if seen.explanation else Estimate(0, 0, 0)
    return Unknown(seen.located.findings, removable, {}, note, beside=beside)
