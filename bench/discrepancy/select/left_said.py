"""What is said to be left without a name: what differs with the names that stand, and no other.

While it is searched effects come and go, and so does what differs beside them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from bench.discrepancy.compare.view import Added
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.in_sight import with_struck_in_sight
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.stepwise import locate_left
from bench.discrepancy.select.verdict import Unknown


def as_it_stands(search: Search, found: Selection) -> Selection:
    """Return the selection whose unknown parts say what differs beside the names that stand.

    With a note on links in sight that are struck (`with_struck_in_sight`). Beside a name for links
    that are struck at random the others are searched. Beside scatter of every row, or a recorder at
    fault, it stays as it is.
    """
    found = with_struck_in_sight(search, found)
    strikes = [turn.strike for turn in found.rounds if turn.strike]
    scattered = any(type(one.effect).independent for one in strikes)
    unknown = any(isinstance(one, Unknown) for one in found.verdicts)
    if scattered or not (found.rounds and unknown):
        return found
    calm = _spared(search, found, strikes)
    findings = Guard().safely("what is left", _differs, ())(calm, found, calm is not search)
    names = tuple(effect.physics for effect in _named(found))
    said = (_with(v, findings, names) if isinstance(v, Unknown) else v for v in found.verdicts)
    return replace(found, verdicts=tuple(said)) if findings else found


def _with(verdict: Unknown, findings: tuple[Finding, ...], names: tuple[str, ...]) -> Unknown:
    """Return a verdict on what a search found beside `names`; what a mark says stays."""
    marked = verdict.cause or not verdict.findings
    return verdict if marked else replace(verdict, findings=findings, beside=names)


def _spared(search: Search, found: Selection, strikes: Iterable[Strike]) -> Search:
    """Return the search on the links that none of the strikes that have a name strikes."""
    said = {name for some in found.names for name in some}
    for one in strikes:
        search = search.spared(one) if one.effect.physics in said else search
    return search


def _differs(search: Search, found: Selection, spared: bool) -> tuple[Finding, ...]:
    """Return what differs beside the effects that have a name, nothing where no search shows it."""
    held = _named(found)
    if not (held or spared):
        return found.rounds[0].located.findings
    return locate_left(search, held, len(found.rounds) + 1).findings


def _named(found: Selection) -> Added:
    """Return the effects that were added and have a name."""
    names = {name for some in found.names for name in some}
    return tuple(effect for effect in found.added if effect.physics in names)
