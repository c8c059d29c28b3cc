"""Links struck as behind a blocked path where the table says line of sight.

Nothing blocks a path that is in sight, so that is no name. But a table often knows of the walls of
a plan alone, and not of who stood in the way.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.far_links import LEAVE_OUT, SIGHT, links_in_the_way
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.link_mixture import Strike, strike
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Unknown


def with_struck_in_sight(search: Search, found: Selection) -> Selection:
    """Return the selection; what is unknown says which links are struck at random, or far off.

    Or what still differs in ranges beside names. Struck ones in sight of ranges alone; as it is
    where none are.
    """
    unknown = any(isinstance(one, Unknown) for one in found.verdicts)
    if not unknown and not (found.names and RANGE in found.left):
        return found
    struck = Guard().safely("sight", struck_in_sight, "")(search, found.added)
    note = struck or Guard().safely("far links", links_in_the_way, "")(search, found.added)
    if not unknown:
        return replace(found, left_note=note)
    first = bool(struck)  # what they look like while these are among them is no news
    noted = (_noted(o, note, first) if isinstance(o, Unknown) else o for o in found.verdicts)
    return replace(found, verdicts=tuple(noted))


def struck_in_sight(search: Search, added: Added) -> str:
    """Return how many links in sight are struck at random beside some effects, "" for none."""
    rows = search.work
    if rows is None or search.fit.waveform or SIGHT not in rows.frame:
        return ""
    blind = View(rows.frame.drop(columns=SIGHT), rows.recorded, rows.links, rows.rows, False)
    found = strike(search.comparison, blind, added, added, search.kinds)
    return _words(rows, found) if found else ""


def _words(rows: View, found: Strike) -> str:
    """Return what is to be said of struck links, "" where none of them is in sight."""
    sight = rows.frame[SIGHT].eq(True).fillna(False).to_numpy(bool)
    seen = np.intersect1d(found.struck, rows.links[sight])
    if not len(seen):
        return ""
    (_, size) = found.parameters[:2]
    return (
        f"{len(found.struck)} of {len(np.unique(rows.links))} links are struck as by "
        f"{found.effect.physics}, by {size.value:.2g} {size.unit} in the mean, but of {len(seen)} "
        f"of these {SIGHT} says line of sight: {LEAVE_OUT}"
    )


def _noted(one: Unknown, note: str, first: bool) -> Unknown:
    notes = (note, one.note) if first else (one.note, note)
    return replace(one, note="; ".join(filter(None, notes)))
