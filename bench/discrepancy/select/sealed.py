"""Sealed links may refuse an effect: what makes ranges worse there has no business in a simulator.

They can only refuse. What stays was chosen on working links, and nothing comes in the place of what
goes but another of a class that these left open (see `sealed_class`): else its name is taken back,
and something is there that has none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

import numpy as np

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.untimed import Untimed
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.confirm import Served, served
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.headline import WITHHELD
from bench.discrepancy.joint.held_out import likelier_struck, likelier_with
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.sealed_class import Change, borne_out_of_class
from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.struck_sealed import struck_nats
from bench.discrepancy.select.verdict import LeftOut, Unknown, Verdict, options_of
from bench.discrepancy.settings import ALL_SPARED, LEAD_NATS
from bench.physics.effect import Effect

STRUCK = Guard().safely("offsets of sealed links", struck_nats, None)
STRUCK_WAVES = Guard().safely("likelihood of struck sealed links", likelier_struck, False)
LIKELIER = Guard().safely("likelihood of sealed links", likelier_with, False)
Borne = Callable[[Strike], bool]  # whether sealed links may be those that a strike leaves
Likelier = Callable[[Effect], bool]  # whether sealed links are likelier with an effect


def unrefused(
    comparison: Comparison, sealed: View, found: Selection, more: Added, seed: int
) -> tuple[Selection, Added]:
    """Return the selection and the unnamed effects without what sealed links refuse.

    One effect after the other goes, as long as score or ranges are worse with the rest than
    without any: the one without which they are best. What a mean score hardly sees, as it strikes
    few links, keeps its name unless it is worse beyond chance and offsets are none of it (20 to 1).
    So does what waveforms speak for here too: what it does to ranges depends on a receiver's
    detector (see `_untimed`). Where their score tells nothing, their likelihood does (see
    `likelier_with`). And so does what has nothing to act on there (no metal stands in any sealed
    link), of which they tell nothing.
    """
    step = Guard().safely("sealed links", served, None)
    judged: dict[tuple[str, ...], Served | None] = {}

    def change(some: Added) -> Served | None:
        key = tuple(effect.name for effect in some)
        if key not in judged:
            judged[key] = step(comparison, sealed, some, seed)
        return judged[key]

    found = borne_out_of_class(found, more, change)
    added = (*found.added, *more)

    @cache
    def likelier(effect: Effect) -> bool:
        return LIKELIER(comparison, sealed, found.added, effect)

    borne = partial(_borne, comparison, sealed, found.added)
    names = {effect.name for effect in _serving(added, change)}
    names -= {effect.name for effect in _unborne(sealed, found, likelier)}
    gone = tuple(effect for effect in added if effect.name not in names)
    if not gone:
        return found, more
    said = _taken_back(found, gone, sealed, _held(found, gone, sealed, change, likelier, borne))
    stay = tuple(e for e in gone if any(e.physics in name for name in said.names))
    able = tuple(e for e in stay if _better_waves(e, change((e,))))
    apart = _untimed(comparison, sealed, tuple(e for e in added if e not in gone), able, seed)
    left = _left_of_ranges(found)
    words = {e.physics: f"{_how(e, apart)}: {_why(change((e,)))}{left}" for e in stay}
    back = {e.name for e in said.added} | {e.name for e in stay if e.physics in apart}
    held_on = tuple(e for e in found.added if e.name in back)
    said = replace(said, added=held_on, withheld={**found.withheld, **words}, untimed=apart)
    return said, tuple(e for e in more if e.name in names)


def _borne(comparison: Comparison, sealed: View, added: Added, strike: Strike) -> bool:
    """Return whether sealed links may be those that a strike leaves, beside the others of `added`.

    With waveforms they must be likelier with it: these tell which links are struck.
    """
    beside = without(added, strike.effect)
    if sealed.waveform:
        return STRUCK_WAVES(comparison, sealed, beside, strike)
    nats = STRUCK(comparison, sealed, beside, strike)
    return nats is not None and nats > -LEAD_NATS


def _held(
    found: Selection,
    gone: Added,
    sealed: View,
    change: Change,
    likelier: Likelier,
    borne: Borne,
) -> set[str]:
    """Return the names of refused effects that sealed links leave standing (see `unrefused`)."""
    seen = {turn.strike.effect.name: turn.strike for turn in found.rounds if turn.strike}
    struck = [(e, seen[e.name]) for e in gone if e.name in seen]
    held = {e.physics for e, one in struck if not _surely_worse(sealed, change((e,)), one, borne)}
    held |= {e.physics for e in gone if (alone := change((e,))) is not None and alone.idle}
    if sealed.waveform:
        sure = _surely_better(found.verdicts)
        held |= {e.physics for e in gone if e.physics in sure and _better_waves(e, change((e,)))}
        unsure = [e for e in gone if _undecided(e, change((e,)))]
        held |= {e.physics for e in unsure if likelier(e)}
    return held


def _how(effect: Effect, apart: tuple[str, ...]) -> str:
    """Return in words how much of an effect the simulator does not have."""
    return "was added without what it does to ranges" if effect.physics in apart else WITHHELD


def _left_of_ranges(found: Selection) -> str:
    """Return in words what differs in ranges with all that was named in place, "" where nothing."""
    last = found.rounds[-1].located.findings if found.rounds else ()
    seen = next((one.told for one in last if one.cell.observable == RANGE), None)
    return f"; with it ranges still differ: {seen}" if seen else ""


def _untimed(
    comparison: Comparison, sealed: View, kept: Added, able: Added, seed: int
) -> tuple[str, ...]:
    """Return the names of effects that serve beside those `kept` if they leave ranges alone.

    All `able` make waveforms better and are refused for their ranges. In a table of another
    simulator's alone: no simulator's file can say so.
    """
    names = tuple(effect.physics for effect in able)
    if not (able and isinstance(comparison, TableComparison)):
        return ()
    step = Guard().safely("effects on waveforms alone", served, None)
    found = step(Untimed(comparison, names), sealed, (*kept, *able), seed)
    return names if found is not None and found.serves else ()


def _why(alone: Served | None) -> str:
    """Return why an effect was not added, from what it does `alone`."""
    if alone is not None and alone.serves:
        return "by itself it makes sealed links better, beside the others it makes them worse"
    return str(alone)


def _surely_better(verdicts: tuple[Verdict, ...]) -> set[str]:
    """Return the names with which working links are better beyond chance."""
    options = (one for verdict in verdicts for one in options_of(verdict))
    return {name for one in options if one.gain.likely_above_zero for name in one.names}


def _better_waves(effect: Effect, found: Served | None) -> bool:
    """Return whether held-out links are better with an effect on waveforms but for their ranges.

    No more is asked: all other links spoke for it, and held-out ones are few.
    """
    return effect.stage != "ranging" and found is not None and found.waves.value > 0


def _unborne(sealed: View, found: Selection, likelier: Likelier) -> Added:
    """Return effects on waveforms that neither working links' score nor sealed ones speak for.

    They were chosen by a likelihood of working links, so that of sealed ones is asked. Not what
    bears a mark of its own, is logged, or strikes links.
    """
    if not sealed.waveform:
        return ()
    named = [v for v in found.verdicts if isinstance(v, LeftOut) and not _bears(v, sealed)]
    unsure = {n for v in named if not v.gain.likely_above_zero for n in v.names}
    struck = [turn.strike.effect for turn in found.rounds if turn.strike]
    unsure -= {e.physics for e in (*found.logged, *struck)}
    able = (e for e in found.added if e.physics in unsure and e.stage != "ranging")
    return tuple(e for e in able if not likelier(e))


def _undecided(effect: Effect, found: Served | None) -> bool:
    """Return whether scores of waveforms alone tell nothing of an effect on held-out links."""
    waves = found.waves if found is not None and effect.stage != "ranging" else None
    return waves is not None and waves.low < 0 < waves.high


def _surely_worse(sealed: View, found: Served | None, strike: Strike, borne: Borne) -> bool:
    """Return whether an effect that strikes links at random makes held-out ones worse, for sure.

    Of waveforms: their ranges. It was seen in links one by one; a score of twenty figures asks for
    its form in all. Ranges that are farther in the median alone refuse nothing: where most links
    are struck the typical simulated one is, too, and spared ones are far from that. Nor does a
    score speak where chance may have spared every held-out link: all are then a little worse with
    it, by what a forecast of rare things costs where none happens. Nor does either where `borne`:
    half of the versions of a link that half are struck of are, and spared ones are far from these.
    """
    if found is None:
        return False
    told = not sealed.waveform and _all_spared(sealed, strike) < ALL_SPARED
    worse = found.surely or (found.gain.high <= 0 and told)
    return worse and not borne(strike)


def _all_spared(sealed: View, strike: Strike) -> float:
    """Return the chance that none of the held-out links is struck; 0 where it is not known.

    As large as the share of struck links, which few links tell, leaves it (its 90 % interval).
    """
    share = next((one.low for one in strike.parameters if one.name == "share"), 1.0)
    return float((1 - share) ** len(np.unique(sealed.links))) if share < 1 else 0.0


def _serving(added: Added, change: Change) -> Added:
    """Return those of some effects that serve together; all where that cannot be judged."""
    kept, now = added, change(added)
    while kept and now is not None and not now.serves:
        rests = [without(kept, effect) for effect in kept]
        judged = [(rest, found) for rest in rests if rest and (found := change(rest))]
        if not judged:
            return ()
        kept, now = max(judged, key=lambda one: one[1].rank)
    return kept


def _taken_back(found: Selection, gone: Added, sealed: View, held: set[str]) -> Selection:
    """Return the selection without refused effects; names that are `held` or marked stay."""
    lost = {effect.physics for effect in gone}
    bad = lost - held
    bad -= {effect.physics for effect in found.logged}
    wrong = [bool(bad & set(v.names[:1])) and not _bears(v, sealed) for v in found.verdicts]
    refused, stay = (
        tuple(v for v, bad in zip(found.verdicts, wrong, strict=True) if bad is asked)
        for asked in (True, False)
    )
    added = tuple(effect for effect in found.added if effect.physics not in lost)
    if not refused or any(isinstance(verdict, Unknown) for verdict in stay):
        return replace(found, verdicts=stay, added=added)
    return replace(found, verdicts=(*stay, _unknown(found, refused)), added=added)


def _bears(verdict: Verdict, sealed: View) -> bool:
    """Return whether rows bear the mark of what a verdict names.

    What is `marked` was fitted by its mark (see `bears_mark`): every range is a point of its grid,
    however far off those are that something else blocks.
    """
    kinds: list[type[Effect]] = [type(one.effect) for one in options_of(verdict)]
    return any(kind.marked or kind.by_mark(sealed.frame) for kind in kinds)


def _unknown(found: Selection, refused: tuple[Verdict, ...]) -> Unknown:
    """Return the verdict on what was named and is refused."""
    turn = next((turn for turn in found.rounds if turn.explanation), None)
    assert turn is not None
    assert turn.explanation is not None
    tried = {c.name: c.gain.value for c in turn.explanation.contenders}
    names = " and ".join(" or ".join(verdict.names) for verdict in refused)
    note = f"looks most like {names}, but links that nothing was tuned on are worse with it"
    return Unknown(turn.located.findings, turn.explanation.removable, tried, note)
