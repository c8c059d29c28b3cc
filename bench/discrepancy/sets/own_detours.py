"""Names of what stands in the way, beside links there that are long by themselves.

Behind an obstacle a link is off by what its own way round is long, on either side of the comparison
and by another length: of some tens of links chance makes a few long on one side alone, and a wall
or an edge of the library may happen to stand in these. So such a name is asked again, at the width
that offsets there have without it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.own_weights import Beside
from bench.discrepancy.sets.settings import CONSTANT_M, NAME_NATS

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def beyond_detours(contest: Contest, causes: Set) -> Set:
    """Return the set without names behind obstacles that links' own detours do nearly as well as.

    They must be worth twice the price of a name more than the set without them, each at the weights
    and the width of offsets that it has by itself.
    """
    for name in [one for one in causes if one in contest.library and _only_behind(contest, one)]:
        if Beside(contest, causes).lead(but(causes, name)) > -NAME_NATS:
            causes = but(causes, name)
    return causes


def _only_behind(contest: Contest, name: str) -> bool:
    """Return whether all that a name can do is in links with something in the way."""
    evidence = contest.evidence
    sight = ~evidence.behind[evidence.links]
    able = np.abs(contest.bare(name))
    return bool(sight.any() and able.any() and able[sight].max(initial=0.0) < CONSTANT_M)
