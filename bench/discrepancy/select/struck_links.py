"""Which links are held to be struck at random: what a user looks at first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.view import View
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.settings import STRUCK_LIST
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, Verdict


def with_struck_links(search: Search, found: Selection) -> Selection:
    """Return the selection whose names of strikes list the links that are held to be struck."""
    strikes = [t.strike for t in found.rounds if t.strike and len(t.strike.struck)]
    for strike in strikes:
        words = Guard().safely("struck links", struck_words, "")(search.both, strike)
        said = tuple(_noted(verdict, strike, words) for verdict in found.verdicts)
        found = replace(found, verdicts=said)
    return found


def struck_words(rows: View, strike: Strike) -> str:
    """Return in words which links of the working rows are held to be struck."""
    names = rows.frame["link"].astype(str).to_numpy()
    struck = list(dict.fromkeys(names[np.isin(rows.links, strike.struck)].tolist()))
    more = f" and {len(struck) - STRUCK_LIST} more" if len(struck) > STRUCK_LIST else ""
    every = len(np.unique(rows.links))
    return f"held to be struck, of {every} working links: {', '.join(struck[:STRUCK_LIST])}{more}"


def _noted(verdict: Verdict, strike: Strike, words: str) -> Verdict:
    """Return a verdict with the words beside its first name, where that is of the strike."""
    if isinstance(verdict, Ambiguous):
        first = _noted(verdict.options[0], strike, words)
        assert isinstance(first, LeftOut)
        return replace(verdict, options=(first, *verdict.options[1:]))
    if isinstance(verdict, LeftOut) and verdict.effect.name == strike.effect.name:
        return replace(verdict, note=words)
    return verdict
