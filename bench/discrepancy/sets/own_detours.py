"""Names of what stands in the way, beside links there that are long by themselves.

Behind an obstacle a link is off by what its own way round is long, on either side of the comparison
and by another length: of some tens of links chance makes a few long on one side alone, and a wall
or an edge of the library may happen to stand in these. So such a name is asked again beside offsets
of these links, of a width of their own: only what they have in common is left to it. Where
simulated links there keep no more than those in sight, chance makes none of recorded ones long.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as variance_ratio

from bench.discrepancy.sets.beside import nats_with
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.settings import (
    CONSTANT_M,
    LAW_M,
    LEAST_VARIANCE_M2,
    RIVAL_NATS,
    WIDER_P,
)

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]
DETOURS = "offsets of the links it acts on"


def beyond_detours(contest: Contest, causes: Set) -> Set:
    """Return the set without names behind obstacles for which offsets of those links do.

    Beside these they must bring what excludes a rival (`RIVAL_NATS`). Asked where simulated links
    have detours there, too.
    """
    for name in [one for one in causes if one in contest.library and _only_behind(contest, one)]:
        if _detours(contest, name) and lead_of(contest, causes, name) < RIVAL_NATS:
            causes = but(causes, name)
    return causes


def lead_of(contest: Contest, causes: Set, name: str) -> float:
    """Return the nats that a name brings beside offsets of the links on which it acts."""
    links = contest.evidence.links
    own = {DETOURS: (contest.seen(LAW_M * (links[:, None] == _acts(contest, name))),)}
    return nats_with(contest, causes, own) - nats_with(contest, but(causes, name), own)


def _acts(contest: Contest, name: str) -> NDArray[np.intp]:
    """Return the links, by number, on which a name can do anything."""
    able = np.abs(contest.bare(name)).max(axis=1) > CONSTANT_M
    return np.unique(contest.evidence.links[able])


def _detours(contest: Contest, name: str) -> bool:
    """Return whether simulated links that a name acts on differ by more than those in sight do.

    Beside all that the name may do there: a variance ratio. Of no more links than it has values
    nothing says that they are alike.
    """
    evidence, links = contest.evidence, contest.evidence.links
    count, acts = np.bincount(links), _acts(contest, name)
    middle_m = np.bincount(links, contest.drawn_m) / count
    ways = np.stack([np.bincount(links, one) / count for one in contest.bare(name).T], axis=1)
    (square, free), (others, many) = (
        _left(middle_m[some], ways[some]) for some in (acts, np.flatnonzero(~evidence.behind))
    )
    if free < 1 or many < 1:
        return free < 1
    ratio = (square / free) / max(others / many, LEAST_VARIANCE_M2)
    return bool(variance_ratio.sf(ratio, free, many) < WIDER_P)


def _left(values: Floats, ways: Floats) -> tuple[float, int]:
    """Return the squares that a constant and ways [l, k] leave of values [l], and their freedom."""
    columns = np.column_stack([np.ones(len(values)), ways])
    factors, _, rank, _ = np.linalg.lstsq(columns, values, rcond=None)
    return float(((values - columns @ factors) ** 2).sum()), len(values) - int(rank)


def _only_behind(contest: Contest, name: str) -> bool:
    """Return whether all that a name can do is in links with something in the way."""
    evidence = contest.evidence
    sight = ~evidence.behind[evidence.links]
    able = np.abs(contest.bare(name))
    return bool(sight.any() and able.any() and able[sight].max(initial=0.0) < CONSTANT_M)
