"""A board that is longer than a screen -> one row per model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from reports.boards import Entry
from reports.load import Results
from reports.overview import Ranked, ranked
from reports.ranking.ranks import Ranking

SCREEN_ROWS = 24


def condensed(one: Ranked, results: Results) -> Ranked:
    """Return the board with one row per model and their ranks, itself where it fits a screen.

    Of each model the cheapest backend is kept that cannot be told apart from the model's best.
    Raises ReportError as `ranked` does.
    """
    entries = one.board.entries
    if len(entries) <= SCREEN_ROWS:
        return one
    models = dict.fromkeys(entry.model for entry in entries)
    kept = {_cheapest([e for e in entries if e.model == m], one.ranking) for m in models}
    board = replace(one.board, entries=[entry for entry in entries if entry.name in kept])
    return replace(ranked(board, results), chosen_of=len(entries))


def _cheapest(entries: Sequence[Entry], ranking: Ranking | None) -> str:
    """Return the name of a model's fastest entry (smallest file) among those tied with its best."""
    letters = {one.name: set(one.groups) for one in ranking.models} if ranking else {}
    best = letters.get(entries[0].name)
    tied = [e for e in entries if best is None or best & letters.get(e.name, set())]
    return min(tied or entries[:1], key=_cost).name


def _cost(entry: Entry) -> tuple[float, float, str]:
    latency = entry.latency(1)
    size = entry.size.file_bytes if entry.size else math.inf
    return latency.median_us if latency else math.inf, size, entry.backend
