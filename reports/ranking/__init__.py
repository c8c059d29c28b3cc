"""Which models differ beyond chance: paired over links, family-wise, with ranks and tie groups."""

from __future__ import annotations

from reports.ranking.families import Family, separate
from reports.ranking.paired import Paired
from reports.ranking.ranks import Ranking, rank

__all__ = ["Family", "Paired", "Ranking", "rank", "separate"]
