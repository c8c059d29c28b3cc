"""Names that do not reproduce what they act on are taken back, or give way to one that does."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from bench.discrepancy.compare.skill import gain_interval, gains
from bench.discrepancy.compare.view import Added, View, without
from bench.discrepancy.fit.sandwich import parameter_intervals
from bench.discrepancy.select.adequacy import Adequacy, adequacy, brought
from bench.discrepancy.select.backfitting import beside_others, polished, pruned
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.constant_level import beyond_a_constant
from bench.discrepancy.select.deformation import needless
from bench.discrepancy.select.essentials import idle, unused
from bench.discrepancy.select.fixed_distance import follows
from bench.discrepancy.select.level_slope import told_by_links
from bench.discrepancy.select.own_scatter import OWN, beyond_causes
from bench.discrepancy.select.predictive_cells import fresh_ensemble, kept, place_weight
from bench.discrepancy.select.scatter_shape import scatters_alike
from bench.discrepancy.select.second_level import calmed
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import calm_for, locate_left, loses, margin, scored
from bench.discrepancy.settings import (
    ADEQUACY_RIVALS,
    ADEQUACY_TOUCHED,
    EQUIVALENT_SHARE,
    MARGIN_NATS,
)
from bench.errors import BenchError
from bench.physics.effect import Effect


@dataclass(frozen=True)
class Doubt:
    """An effect that gained most, but whose response recordings do not look like."""

    effect: Effect
    why: Adequacy

    def __str__(self) -> str:
        return self.why.against(self.effect.physics)


@dataclass(frozen=True)
class Checked:
    """What was checked: a statement and a simulator, which are separate questions.

    `added` are the effects that reproduce what they act on and may be named; `doubts` say why
    others may not. `whole` is what fits best: these with the refused ones that held-out links miss,
    () where none is missed.
    """

    added: Added
    rounds: tuple[Round, ...]
    doubts: tuple[Doubt, ...] = ()
    whole: Added = ()

    @property
    def simulated(self) -> Added:
        """The effects in whose company every name is judged."""
        return self.whole or self.added


def working(search: Search) -> tuple[View, ...]:
    """Return all working rows as views."""
    return (search.fit, search.discover) if search.work is None else (search.work,)


def checked(search: Search, rounds: tuple[Round, ...], added: Added) -> Checked:
    """Return the effects without those that are refuted, each judged in the company of all.

    What is refuted gives way to a rival of its round that is not, where there is one. Else it is
    no name; but it is taken out only where held-out links do not miss it when the rest is fitted
    without it: what it did would fall on others, which would then be refuted for its sake.
    """
    gone: tuple[Doubt, ...] = ()
    refuted: set[str] = set()
    first = added = _without_forms(search, added)
    for _ in range(2 * len(added)):
        fresh = [d for d in _refuted(search, rounds, added) if d.effect.physics not in refuted]
        if not fresh:
            break
        worst = fresh[0].effect
        refuted.add(worst.physics)
        rival = _adequate_rival(search, rounds, added, worst, refuted)
        if rival is not None:
            rounds = tuple(_renamed(turn, worst, rival) for turn in rounds)
            added = swapped_for(added, worst, rival.effect)
        elif len(rest := _unmissed(search, added, worst)) < len(added):
            gone, added = (*gone, fresh[0]), rest
    for effect in first if search.fit.waveform else ():
        rounds, added = _taken_again(search, rounds, added, effect)
    back = {effect.name for effect in added}
    return _stated(search, rounds, added, _nameless(d for d in gone if d.effect.name not in back))


def _nameless(doubts: Iterable[Doubt]) -> tuple[Doubt, ...]:
    """Return the doubts without those of scatter that a named cause makes: that has its name."""
    return tuple(doubt for doubt in doubts if doubt.why.note not in OWN)


def _unmissed(search: Search, added: Added, effect: Effect) -> Added:
    """Return the effects fitted without one of them, or as they are where held-out links miss it.

    Missed: the others, fitted anew, lose what an effect must be worth.
    """
    rest = polished(search.comparison, search.fit, without(added, effect), 1, False)
    return added if search.fit.waveform and loses(search, rest, added) else rest


def _taken_again(
    search: Search, rounds: tuple[Round, ...], added: Added, effect: Effect
) -> tuple[tuple[Round, ...], Added]:
    """Return rounds and effects with a refused one among them again, where it now holds.

    What came in the place of another may have lifted what spoke against a third.
    """
    if any(known.physics == effect.physics for known in added):
        return rounds, added
    both = polished(search.comparison, search.fit, (*added, effect), 1, False)
    made, turn = both[-1], _brought_by(rounds, effect)
    more = announced(search, rounds[-1], both, made)
    assert more.explanation is not None
    gained = more.explanation.removable
    worth = gained.likely_above_zero and gained.value > margin(search, added)
    if not (worth and fits(search, both, made, turn).adequate):
        return rounds, added
    return (rounds if turn else (*rounds[:-1], more, rounds[-1])), both


def announced(search: Search, last: Round, added: Added, effect: Effect) -> Round:
    """Return a round that adds an effect beside others, with what it gains there."""
    before, after = (scored(search, each) for each in (without(added, effect), added))
    gained = gain_interval(before, after, search.seed)
    alone = Explanation((Contender(effect, after, gained),), before, gained, after, {}, {})
    return Round(last.located, alone, effect)


def _stated(
    search: Search, rounds: tuple[Round, ...], whole: Added, gone: tuple[Doubt, ...]
) -> Checked:
    """Return which effects are names: those that are not refused and do without the refused ones.

    What helps only beside a refused effect mends the form of that, and is no cause of its own.
    """
    doubts = _refuted(search, rounds, whole)
    added, fillers = _standing(search, whole, doubts) if doubts else (whole, ())
    doubts = _nameless(doubts)
    needed = doubts or (gone and _left(search, rounds, added))
    doubts = (*gone, *doubts, *fillers)
    loudest = _loudest(search, rounds, added)
    if not loudest.adequate:
        return Checked((), rounds, (*doubts, *(Doubt(e, loudest) for e in added)), whole)
    return Checked(added, rounds, doubts if needed else (), whole if added != whole else ())


def _standing(
    search: Search, whole: Added, refused: tuple[Doubt, ...]
) -> tuple[Added, tuple[Doubt, ...]]:
    """Return the effects that are missed without the refused ones, and doubts of the others.

    Those of a set of causes were weighed on ranges alone, where little may be much.
    """
    names = {doubt.effect.name for doubt in refused}
    rest = tuple(effect for effect in whole if effect.name not in names)
    rest = polished(search.comparison, search.fit, rest, 1, False)
    least = margin(search, rest)
    held = pruned(search.comparison, search.discover, rest, search.seed, least)
    why = Adequacy(False, note=f"it helps only beside {' and '.join(sorted(names))}")
    sure = {effect.name for effect in held} | set(search.choice.names)
    held = tuple(effect for effect in rest if {effect.name, effect.physics} & sure)
    return held, tuple(Doubt(effect, why) for effect in rest if effect not in held)


def _loudest(search: Search, rounds: tuple[Round, ...], added: Added) -> Adequacy:
    """Return whether all effects together cut down the loudest thing that was there at first.

    With waveforms: names for the rest alone would pass over what is there.
    """
    if not (added and search.fit.waveform):
        return Adequacy(True)
    views, top = working(search), rounds[0].located.findings[:1]
    whole, bare = (fresh_ensemble(search.comparison, views, one) for one in (added, ()))
    names = tuple(name for name in whole.names if name in bare.names)
    wanted = [(finding.cell, place_weight(views, finding.cell.place)) for finding in top]
    return brought(kept(whole, names), kept(bare, names), wanted)


def _without_forms(search: Search, added: Added) -> Added:
    """Return the effects without those that another form of a larger one would be.

    With waveforms, where one effect moves twenty observables.
    """
    sure = search.choice.names
    while search.fit.waveform and (
        small := needless(search.comparison, working(search), added, sure)
    ):
        if _most_missed(search, added, small):
            break
        added = polished(search.comparison, search.fit, without(added, small), 1, False)
    return added


def _most_missed(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether held-out links miss no other effect more where this one acts.

    Each is left out and the rest fitted again. What is missed most is no form of another.
    """
    whole = scored(search, added)
    rests = {
        e.name: polished(search.comparison, search.fit, without(added, e), 1, False) for e in added
    }
    lost = {name: gains(scored(search, rest), whole) for name, rest in rests.items()}
    most = max(lost[effect.name].values())
    acts = [name for name, nats in lost[effect.name].items() if nats > ADEQUACY_TOUCHED * most]
    missed = {name: sum(each.get(one, 0.0) for one in acts) for name, each in lost.items()}
    own = missed.pop(effect.name)
    return own > margin(search, rests[effect.name]) and own >= max(missed.values())


def _left(search: Search, rounds: tuple[Round, ...], added: Added) -> bool:
    """Return whether the effects that hold leave anything: else what was refuted was not needed.

    What another form of theirs would do to levels is nothing left.
    """
    turn = len(rounds)
    return not added or calmed(search, added, locate_left(search, added, turn), turn).significant


def fits(search: Search, added: Added, effect: Effect, turn: Round | None = None) -> Adequacy:
    """Return the adequacy of an effect on all working rows; one that cannot be judged passes.

    `turn` is the round that brought it in.
    """
    wanted = tuple(finding.cell for finding in turn.located.findings) if turn else ()
    try:
        search = calm_for(search, added, effect)
        wrong = _idle(search, added, effect)
        if wrong:
            return _instead(search, added, effect, wrong)
        found = adequacy(search.comparison, working(search), added, effect, wanted)
        if not found.adequate or search.work is None:
            return found
        found = follows(search.comparison, search.work, added, effect)
        for asked in (scatters_alike, beyond_a_constant):
            other = asked(search.comparison, search.work, added, effect)
            found = found if other.adequate else other
        return found if not found.adequate else beyond_causes(search, added, effect)
    except BenchError:
        return Adequacy(True)


def _idle(search: Search, added: Added, effect: Effect) -> str:
    """Return what is wrong with an essential parameter, in words, "" where nothing is."""
    if search.fit.waveform and (words := unused(effect)):
        return words
    kind = type(effect)
    if any(getattr(effect, name) for name in kind.instead):
        return ""
    needed = kind.essential + (() if search.fit.waveform else kind.essential_on_paths)
    wanted = {p.name: p for p in effect.parameters() if p.name in needed}
    if not wanted:
        return ""
    rest = without(added, effect)
    found = parameter_intervals(search.comparison, search.sharpest, rest, effect)
    found = told_by_links(search, rest, effect, found)
    every = (idle(wanted[one.name], one) for one in found if one.name in wanted)
    return next((words for words in every if words), "")


def _instead(search: Search, added: Added, effect: Effect, wrong: str) -> Adequacy:
    """Return what is wrong with an effect: so many dB in all rows where these do as well."""
    said = Adequacy(False, 1.0, note=wrong)
    if search.work is None:
        return said
    constant = beyond_a_constant(search.comparison, search.work, added, effect)
    return said if constant.adequate else constant


def swapped_for(added: Added, gone: Effect, come: Effect) -> Added:
    """Return the effects with another one in the place of one."""
    return tuple(come if effect.name == gone.name else effect for effect in added)


def _brought_by(rounds: tuple[Round, ...], effect: Effect) -> Round | None:
    """Return the round that added an effect, None where none did."""
    return next((turn for turn in rounds if turn.added and turn.added.name == effect.name), None)


def _refuted(search: Search, rounds: tuple[Round, ...], added: Added) -> tuple[Doubt, ...]:
    """Return the effects of which more is left than is allowed, beside all others; worst first."""
    sure = {*search.choice.names, *(effect.name for effect in search.logged)}
    left = (e for e in added if e.physics not in sure)
    left = (e for e in left if search.fit.waveform or not type(e).marked)
    doubts = [Doubt(e, fits(search, added, e, _brought_by(rounds, e))) for e in left]
    doubts = [doubt for doubt in doubts if not doubt.why.adequate]
    return tuple(sorted(doubts, key=lambda doubt: -doubt.why.left))


def _adequate_rival(
    search: Search, rounds: tuple[Round, ...], added: Added, effect: Effect, refuted: set[str]
) -> Contender | None:
    """Return the best contender of the effect's round that fits in its place, None without one.

    It must have gained nearly as much there: the next best of a mismatch it hardly touches is no
    answer. None of the `refuted` comes back.
    """
    turn = _brought_by(rounds, effect)
    if turn is None or turn.explanation is None:
        return None
    rest, have = without(added, effect), {known.physics for known in added}
    every = turn.explanation.contenders
    gone = next((c.gain.value for c in every if c.name == effect.physics), 0.0)
    least = max(MARGIN_NATS, EQUIVALENT_SHARE * gone)
    able = [c for c in every if c.name not in have | refuted]
    if type(effect).marked:  # scatter leaves no mark
        able = [c for c in able if not type(c.effect).independent]
    able = [c for c in able if c.gain.likely_above_zero and c.gain.value > least]
    for one in able[:ADEQUACY_RIVALS]:
        found = beside_others(search.comparison, search.fit, rest, one, search.kinds)
        if found and fits(search, (*rest, found.effect), found.effect, turn).adequate:
            return replace(one, effect=found.effect)
    return None


def _renamed(turn: Round, gone: Effect, come: Contender) -> Round:
    """Return a round with a rival in the place of what it added."""
    if turn.added is None or turn.added.name != gone.name or turn.explanation is None:
        return turn
    rest = (c for c in turn.explanation.contenders if c.name not in (gone.physics, come.name))
    explanation = replace(turn.explanation, contenders=(come, *rest))
    return replace(turn, added=come.effect, explanation=explanation)
