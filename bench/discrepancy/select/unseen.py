"""What no search saw and whose name does not stand is nothing: chance names something, too."""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.verdict import NoMismatch, Unknown


def without_unseen(found: Selection) -> Selection:
    """Return the selection that says nothing where all it named is refused and no search saw more.

    A set of causes is weighed even where no place stands out: it may have a shape that no interval
    has. Where its names are then refused (sealed links are worse with it, or none of its values is
    told from zero) nothing is left that speaks for anything: what a later search found beside
    these, they made. So it is with scatter of every row.
    What a mark shows, or strikes some links, stays.
    """
    rounds = found.rounds
    strikes = [turn.strike for turn in rounds if turn.strike]
    scatters = all(type(one.effect).independent for one in strikes)
    asked = (any(turn.added for turn in rounds) or bool(strikes)) and not found.added
    quiet = bool(rounds) and not rounds[0].located.significant and scatters
    lone = all(isinstance(v, Unknown) and not (v.cause or v.findings) for v in found.verdicts)
    if not (asked and quiet and lone and found.verdicts):
        return found
    first = rounds[0].located
    return replace(found, verdicts=(NoMismatch(first.detectable, first.p),), withheld={})
