"""Links that some effects of a set leave alone, as those with nothing in the way.

How far simulated links scatter is pooled over all of them. What stands in the way of a few widens
that scatter for these alone: spread over all links it would be too small for the few, and links
that nothing happens to would lie too near to, or too far from, what is simulated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.covariances import Covariances
from bench.discrepancy.joint.drawn import WithDrawn
from bench.discrepancy.joint.settings import LEAST_MOVED, TOUCHED_P

if TYPE_CHECKING:
    from bench.discrepancy.joint.statistics import Moments

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
Marks = NDArray[np.bool_]


@dataclass(frozen=True)
class Spared:
    """Links that are left `alone` [L], and the covariances by which these scatter, by rows."""

    alone: Marks
    covariances: Mapping[int, Floats]


def beside(added: Added) -> Added:
    """Return the effects that act on all links: without those of what stands in the way."""
    return tuple(one for one in added if not any("obstacles" in way for way in type(one).needs))


def among_touched(found: Moments, rest: Moments | None, count: Codes) -> Moments:
    """Return the statistics with the scatter of touched links, and that of those left alone.

    `rest` are those without what stands in the way, if anything does; `count` [L] the rows of
    links. Pooled scatter of both differs by what touched links do: so much of it, times all links
    over these, is theirs.
    """
    if rest is None:
        return found
    alone = np.all(np.abs(found.mean - rest.mean) <= LEAST_MOVED, axis=1)
    whole, plain = _pooled(found.covariances), _pooled(rest.covariances)
    if whole is None or plain is None or not 0 < alone.sum() < len(alone):
        return found
    touched = ~alone
    links = len(alone) / touched.sum()
    rows = (count - 1).sum() / max((count - 1)[touched].sum(), 1)
    own = replace(
        whole,
        link=plain.link + links * _wider(whole.link - plain.link),
        rows=plain.rows + rows * _wider(whole.rows - plain.rows),
    )
    return replace(found, covariances=own, spared=Spared(alone, rest.covariances))


def _wider(more: Floats) -> Floats:
    """Return of what a covariance differs by [p, p] what widens it: few links tell no narrowing."""
    sizes, ways = np.linalg.eigh((more + more.T) / 2)
    return np.asarray((ways * np.maximum(sizes, 0)) @ ways.T)


def of_touched(change: Floats, code: Codes, spared: Spared | None) -> tuple[Floats, Codes]:
    """Return changes [m, n, p] and codes [n] of the rows of links that are not left alone."""
    if spared is None:
        return change, code
    touched = ~spared.alone[code]
    return change[:, touched], np.unique(code[touched], return_inverse=True)[1]


def _pooled(covariances: Mapping[int, Floats]) -> Covariances | None:
    """Return covariances as they are pooled over links, without what effects draw."""
    if isinstance(covariances, WithDrawn):
        return covariances.whole
    return covariances if isinstance(covariances, Covariances) else None


def only_touched(spared: Spared | None, struck: Marks) -> bool:
    """Return whether what strikes some links [L] strikes only those that obstacles touch already.

    By chance it would seldom, so it is another form of what these do.
    """
    if spared is None or not struck.any() or spared.alone[struck].any():
        return False
    return float((1 - spared.alone.mean()) ** struck.sum()) <= TOUCHED_P


def scattered_as(moments: Moments, other: Moments) -> Moments:
    """Return statistics whose links scatter as others do."""
    return replace(moments, covariances=other.covariances, spared=other.spared)
