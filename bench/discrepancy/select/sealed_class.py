"""Of a class of names, sealed links refuse one by one: what they bear out stays.

Working links left open which of a class it is, so none of it came before the others: a first that
sealed links refuse says nothing of the others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.confirm import Served
from bench.discrepancy.headline import WITHHELD
from bench.discrepancy.select.separate import one_of
from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, Verdict

Change = Callable[[Added], Served | None]  # what effects do to sealed links


def borne_out_of_class(found: Selection, more: Added, change: Change) -> Selection:
    """Return the selection with that of a class in place which sealed links bear out.

    Asked where they refuse the effects that were added, a class's first among them. Another of it
    must make them better, by the score and not by farther ranges, in its place: beyond chance where
    the first makes them worse beyond chance, else as it would have had to. What could not be tried
    stays in the class, as open as it was.
    """
    for verdict in found.verdicts:
        now = change((*found.added, *more))
        if now is None or now.serves:
            return found
        if isinstance(verdict, Ambiguous) and verdict.options[0].effect in found.added:
            found = _in_its_place(found, verdict, now, more, change)
    return found


def _in_its_place(
    found: Selection, verdict: Ambiguous, now: Served, more: Added, change: Change
) -> Selection:
    """Return the selection with the best other of a class that sealed links bear out, if any."""
    first, *others = verdict.options
    rest = without(found.added, first.effect)
    tried = [one for one in others if not one.note]
    judged = {one.names: change((*rest, one.effect, *more)) for one in tried}
    by_chance = now.gain.high > 0
    able = {
        name: got
        for name, got in judged.items()
        if got and got.serves and (by_chance or got.gain.above_zero)
    }
    if not able:
        return found
    best = max((one for one in tried if one.names in able), key=lambda one: able[one.names].rank)
    doubtful = (first,) * (now.gain.high >= able[best.names].gain.low)
    open_yet = (o for o in others if o is not best and (o.note or o.names in able))
    said = one_of((best, *open_yet, *doubtful))
    words = f"{WITHHELD}: {now}; {best.names[0]}, which other links do not tell from it, is better"
    return replace(
        found,
        verdicts=tuple(said if one is verdict else one for one in found.verdicts),
        added=(*rest, best.effect),
        withheld={**found.withheld, first.names[0]: words},
        sealed_choice=(*found.sealed_choice, *verdict.names),
    )


def named_once(verdicts: tuple[Verdict, ...]) -> tuple[Verdict, ...]:
    """Return the verdicts, no class with a name that another verdict gives for sure.

    What is there in any case is no alternative to the others of the class. What could not be tried
    is: walls of other makes beside one that all ways have in common.
    """
    sure = {verdict.names[0] for verdict in verdicts if isinstance(verdict, LeftOut)}
    return tuple(_but(verdict, sure) for verdict in verdicts)


def _but(verdict: Verdict, sure: set[str]) -> Verdict:
    """Return a verdict, of a class what is not among some names; as it is if nothing is left."""
    if not isinstance(verdict, Ambiguous):
        return verdict
    able = verdict.options
    left = tuple(one for one in able if one.names[0] not in sure or not one.tried)
    return one_of(left) if left and len(left) < len(able) else verdict
