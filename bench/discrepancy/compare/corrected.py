"""How much every simulated link has in what stands for a recorded one, corrections with it.

A recorded link is compared with the mean of similar simulated ones, from which it is taken off what
observables walk over distance, kinds of links and what else is known. All simulated links tell
this: what they are off by chance is in all recorded links that are corrected alike.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.discrepancy.compare.over_distance import Walk, of_links
from bench.discrepancy.compare.over_kinds import OfKinds
from bench.discrepancy.compare.settings import LEAST_SINGULAR
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats


def moved(shares: Floats, ours: Sequence[Floats], theirs: Sequence[Floats]) -> Floats:
    """Return how far what stands for links `ours` is moved [L, q], in what walks and kinds do.

    `shares` [L, K] are those of simulated links `theirs` in the mean of similar ones. Of both: what
    a walk over the distance is made of [L, 2], then by layer which kind links are of [L, c], last
    blocks of what else is known [L, w].
    """
    parts = [here - shares @ there for here, there in zip(ours, theirs, strict=True)]
    return np.hstack(parts)


def told_by(
    theirs: Sequence[Floats], walk: Walk, of: Sequence[OfKinds], known: Sequence[float]
) -> Floats:
    """Return the weights [q, K] of simulated links in what a walk, kinds and blocks do.

    See `moved`. What is told in part is off by as much of its variance (a random effect); `known`
    are the parts of blocks.
    """
    last = 1 + len(of)
    parts = [_walked(theirs[0], theirs[last - 1], walk)]
    for there, kinds in zip(theirs[1:last], of, strict=True):
        told = np.sqrt(np.where(np.isfinite(kinds.step), kinds.told, 0.0))
        mean = told[:, None] * (there / np.maximum(there.sum(axis=0), 1)).T
        parts.append(_beside(mean, theirs, parts))
    for there, told_of in zip(theirs[last:], known, strict=True):
        apart = np.linalg.pinv(there - there.mean(axis=0), LEAST_SINGULAR)
        parts.append(_beside(np.sqrt(told_of) * apart, theirs, parts))
    return np.vstack(parts)


def _beside(weights: Floats, theirs: Sequence[Floats], parts: Sequence[Floats]) -> Floats:
    """Return weights of links in one correction of what those before it leave."""
    before = zip(theirs, parts, strict=False)
    return np.asarray(weights - sum((weights @ one) @ part for one, part in before))


def _walked(far: Floats, of_kind: Floats, walk: Walk) -> Floats:
    """Return the weights [2, K] of simulated links in a walk, told within their last kinds."""
    mean = (of_kind / np.maximum(of_kind.sum(axis=0), 1)).T
    inside = far - of_kind @ (mean @ far)
    tilt = float(inside[:, 0] @ inside[:, 1]) / max(float(inside[:, 0] @ inside[:, 0]), 1e-30)
    apart = np.array([[1.0, -tilt], [0.0, 1.0]])  # what the bend is beside the slope
    told = np.sqrt(walk.told)[:, None]
    return np.asarray(apart @ (told * np.linalg.pinv(inside @ apart, LEAST_SINGULAR)))


def places(
    range_m: Floats, links: Rows, layers: Sequence[tuple[Rows, int]], blocks: Sequence[Floats]
) -> list[Floats]:
    """Return what says where `links` [n] are, in the order of their numbers (see `told_by`).

    `layers`: the kind of every row [n], and how many there are; `blocks` [n, w]: all else.
    """
    decades = np.log10(np.where(range_m > 0, range_m, 1.0))
    code = of_links(links, links)[0]
    far = np.bincount(code, decades) / np.bincount(code)
    kinds = [of_links(links, kind)[1][:, None] == np.arange(many) for kind, many in layers]
    known = [
        np.stack([np.bincount(code, one) / np.bincount(code) for one in block.T], axis=1)
        for block in blocks
    ]
    return [np.stack([far, far**2], axis=1), *(one.astype(np.float64) for one in kinds), *known]
