"""Numbers that decide about fits of values: unit, reason, and in brackets the origin."""

from __future__ import annotations

from typing import Final

WALL_PRIOR_M: Final = 1.0  # typical delay of one obstacle at most: 0.8 m of concrete
# [source: ITU-R P.2040-3, table 3]
WALL_PRIOR_DB: Final = 30.0  # typical loss of one obstacle at most [source: the same]
