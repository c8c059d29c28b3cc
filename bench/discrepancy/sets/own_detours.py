"""Names of what stands in the way, beside links there that are long by themselves.

Behind an obstacle a link is off by what its own way round is long, on either side of the comparison
and by another length: of some tens of links chance makes a few long on one side alone, and a wall
or an edge of the library may happen to stand in these. So such a name is asked again beside offsets
of these links, of a width of their own: only what they have in common is left to it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.beside import nats_with
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.settings import CONSTANT_M, LAW_M, RIVAL_NATS

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

DETOURS = "offsets of the links it acts on"


def beyond_detours(contest: Contest, causes: Set) -> Set:
    """Return the set without names behind obstacles for which offsets of those links do.

    Beside these they must bring what excludes a rival (`RIVAL_NATS`).
    """
    for name in [one for one in causes if one in contest.library and _only_behind(contest, one)]:
        if lead_of(contest, causes, name) < RIVAL_NATS:
            causes = but(causes, name)
    return causes


def lead_of(contest: Contest, causes: Set, name: str) -> float:
    """Return the nats that a name brings beside offsets of the links on which it acts."""
    links = contest.evidence.links
    acts = np.unique(links[np.abs(contest.bare(name)).max(axis=1) > CONSTANT_M])
    own = {DETOURS: (contest.seen(LAW_M * (links[:, None] == acts)),)}
    return nats_with(contest, causes, own) - nats_with(contest, but(causes, name), own)


def _only_behind(contest: Contest, name: str) -> bool:
    """Return whether all that a name can do is in links with something in the way."""
    evidence = contest.evidence
    sight = ~evidence.behind[evidence.links]
    able = np.abs(contest.bare(name))
    return bool(sight.any() and able.any() and able[sight].max(initial=0.0) < CONSTANT_M)
