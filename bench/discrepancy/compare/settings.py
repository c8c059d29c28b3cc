"""Every number that decides about comparing with a table: unit, reason, and its origin.

Origins in brackets as in `bench.discrepancy.settings`.
"""

from __future__ import annotations

from typing import Final

FREE_SPACE_DB: Final = -20.0  # that a level changes per decade of distance (Friis) [physics]
SLOPE_LINKS: Final = 8  # at least, to tell what a table does over the distance [convention]
