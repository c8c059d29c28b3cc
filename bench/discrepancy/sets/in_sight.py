"""The rows that tell what devices have of their own: those of links in sight, where these are many.

Behind what stands in the way links are off by more, and by more in some than in others: offsets
that nobody foretells, with which a delay, a scale or nothing may happen to go.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.sets.settings import FEWEST_IN_SIGHT

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def telling(contest: Contest) -> NDArray[np.bool_]:
    """Return the rows [n] of the evidence in sight where their links are many, else all."""
    sight = contest.rows.scene.clear()[contest.known]
    several = len(np.unique(contest.evidence.links[sight])) >= FEWEST_IN_SIGHT
    return np.asarray(sight if several else np.ones(len(sight), bool))
