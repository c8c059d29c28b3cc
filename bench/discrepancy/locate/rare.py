"""Links and single rows of ranges beyond all simulated ones: too few for a mean to show them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import LEAST_SCATTER_M, RARE_BEYOND, RARE_FEWEST, RARE_P, ROWS_P

Floats = NDArray[np.float64]


def struck_links(ensemble: Ensemble, crowding: float = 1.0) -> tuple[float, bool]:
    """Return how far the most deviant recorded link is off in scatters of links, and if by fault.

    A few struck links among many hardly move a mean, and with few simulated versions permutations
    cannot tell them. Scatter is borrowed across links: offsets of all simulated links beside the
    others' mean. A recorded link must be beyond the widest of them, and beyond a normal quantile.
    Where simulated links stand for several (`crowding`, as in `locate`) they are other links than
    the recorded ones, and of either the widest may be one that missed its first path: then so many
    must be off as chance does not pick of all (see `struck_rows`).
    """
    if not _told(ensemble):
        return 0.0, False
    versions = ensemble.versions_of(RANGE)
    code = np.unique(ensemble.links, return_inverse=True)[1]
    m = len(versions) - 1
    offset = _link_offsets(versions[0] - versions[1:].mean(axis=0), code)
    others = (versions[1:].sum(axis=0) - versions[1:]) / (m - 1)
    narrower = np.sqrt((1 + 1 / m) / (1 + 1 / (m - 1)))
    own = np.stack([_link_offsets(row, code) for row in versions[1:] - others]) * narrower
    scatter = max(float(np.sqrt(np.nanmean(own**2))), LEAST_SCATTER_M)
    most = float(np.nanmax(np.abs(offset), initial=0.0))
    p = float(min(1.0, 2 * norm.sf(most / scatter) * len(offset)))
    beyond = RARE_BEYOND * float(np.nanmax(np.abs(own), initial=0.0))
    every = np.nan_to_num(np.abs(np.vstack([offset, own])))
    picked = crowding > 1 and _first_by_chance(every, beyond, crowding) > ROWS_P
    return most / scatter, p <= RARE_P and most >= beyond and not picked


def struck_rows(ensemble: Ensemble, crowding: float = 1.0) -> tuple[float, float]:
    """Return the p value of rows of the recorded ranges beyond all simulated ones, and how far.

    A few late rows hardly move a mean, nor most rows of their links. Every version of a link is
    told by its row that is most off from the median over versions. Under the null any version may
    hold the widest, so that the first k of L (1 + m) all are recorded has the probability
    C(L, k) / C(L (1 + m), k), exact for any dependence inside a link (compare the order statistics
    of David and Nagaraja 2003). Counted are links that are `RARE_BEYOND` times the widest simulated
    one off: 1.0 where there are none, or too few versions to say which of them is off. `crowding`
    as in `locate`: simulated rows that are used again are fewer than they look.
    """
    if not _told(ensemble):
        return 1.0, 0.0
    most = _most_off(ensemble.versions_of(RANGE), ensemble.links)
    widest = float(most[1:].max(initial=0.0))
    p = _first_by_chance(most, RARE_BEYOND * widest, crowding)
    return p, float(most[0].max(initial=0.0)) / widest if widest > 0 else 0.0


def struck_above(
    versions: Floats, links: NDArray[np.intp], least: float, crowding: float = 1.0
) -> float:
    """Return the p value of recorded rows above all simulated ones, and above `least` (as there).

    `versions` [1 + m, n] of rows of `links` [n], the recorded one first, beside their median.
    """
    above = np.maximum(versions - np.median(versions, axis=0), 0.0)
    most = _most_off(above, links)
    beyond = max(RARE_BEYOND * float(most[1:].max(initial=0.0)), least)
    return _first_by_chance(most, beyond, crowding)


def _first_by_chance(most: Floats, beyond: float, crowding: float) -> float:
    """Return the chance that all links [1 + m, L] `beyond` are recorded (see `struck_rows`)."""
    links, many = most.shape[1], int((most[0] > beyond).sum())
    drawn = links * (1 + (len(most) - 1) / crowding**2)
    return float(np.prod((links - np.arange(many)) / (drawn - np.arange(many))))


def _most_off(versions: Floats, links: NDArray[np.intp]) -> Floats:
    """Return how far the most deviant row of each link is off in each version: [1 + m, L]."""
    known = np.isfinite(versions).all(axis=0)
    inside, code = versions[:, known], np.unique(links[known], return_inverse=True)[1]
    off = np.abs(inside - np.median(inside, axis=0))
    most = np.zeros((len(versions), int(code.max(initial=-1)) + 1))
    for row, values in zip(most, off, strict=True):
        np.maximum.at(row, code, values)
    return most


def _told(ensemble: Ensemble) -> bool:
    """Return whether there are ranges, and enough versions to say which of them is off."""
    return RANGE in ensemble.names and len(ensemble.simulated) >= RARE_FEWEST


def _link_offsets(values: Floats, code: NDArray[np.intp]) -> Floats:
    """Return by how much most rows of each link are off at least, from values [n]: [L].

    Half of an even number is not most: of two rows that which is less off.
    """
    order = np.argsort(code, kind="stable")
    parts = np.split(values[order], np.flatnonzero(np.diff(code[order])) + 1)
    return np.array([_of_most(part[np.isfinite(part)]) for part in parts])


def _of_most(values: Floats) -> float:
    """Return the median; of an even number the middle one that is nearer to zero."""
    middle = np.sort(values)[(len(values) - 1) // 2 : len(values) // 2 + 1]
    return float(middle[np.abs(middle).argmin()]) if len(middle) else float("nan")
