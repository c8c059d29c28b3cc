"""The columns of a leaderboard that say which rows can be told apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from reports.boards import Entry
from reports.document import Cell, Column
from reports.measures import Figure, Measure
from reports.numbers import UNKNOWN

if TYPE_CHECKING:
    from reports.ranking.ranks import Ranking


def rank_column(ranking: Ranking | None) -> Measure:
    """Return the interval of each row's rank; bold where it may be the best."""
    found = {one.name: one for one in ranking.models} if ranking else {}

    def read(entry: Entry) -> Figure:
        one = found.get(entry.name)
        return Figure(Cell(one.ranks, best=one.best_rank == 1) if one else Cell(UNKNOWN))

    return Measure(Column("Rank", number=False), read)


def ties_column(ranking: Ranking | None) -> Measure:
    """Return the letters of each row's tie groups."""
    found = {one.name: one.letters for one in ranking.models} if ranking else {}
    return Measure(
        Column("Ties", number=False),
        lambda entry: Figure(Cell(found.get(entry.name, UNKNOWN))),
    )
