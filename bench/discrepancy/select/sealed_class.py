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
from bench.discrepancy.select.separate import separating
from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, Verdict

Change = Callable[[Added], Served | None]  # what effects do to sealed links


def borne_out_of_class(found: Selection, more: Added, change: Change) -> Selection:
    """Return the selection with that of a class in place which sealed links bear out.

    Asked where they refuse the effects that were added, a class's first among them. Another of it
    must make them better beyond chance, by the score and not by farther ranges, in its place.
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
    judged = [(one, change((*rest, one.effect, *more))) for one in others]
    able = [(one, got) for one, got in judged if got and got.serves and got.gain.above_zero]
    if not able:
        return found
    best, got = max(able, key=lambda one: one[1].rank)
    clear = now.gain.high < got.gain.low
    said = _said(verdict, best, [o for o, _ in able if o is not best], [first] * (not clear))
    verdicts = tuple(said if one is verdict else one for one in found.verdicts)
    words = f"{WITHHELD}: {now}; {best.names[0]}, which other links do not tell from it, is better"
    withheld = {**found.withheld, first.names[0]: words}
    told = (*found.sealed_choice, *verdict.names)
    added = (*rest, best.effect)
    return replace(found, verdicts=verdicts, added=added, withheld=withheld, sealed_choice=told)


def _said(
    verdict: Ambiguous, best: LeftOut, able: list[LeftOut], doubtful: list[LeftOut]
) -> Verdict:
    """Return what is left of a class; the first of it stays where chance may have refused it."""
    options = (best, *able, *doubtful)
    if len(options) == 1:
        return best
    return replace(verdict, options=options, separate=separating(options))
