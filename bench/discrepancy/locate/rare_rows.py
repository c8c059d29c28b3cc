"""Single rows far beyond what any simulated row reads: a few late ranges, on a few links."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import RARE_BEYOND, RARE_FEWEST

Floats = NDArray[np.float64]


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
    if RANGE not in ensemble.names or len(ensemble.simulated) < RARE_FEWEST:
        return 1.0, 0.0
    most = _most_off(ensemble.versions_of(RANGE), ensemble.links)
    widest = float(most[1:].max(initial=0.0))
    links, beyond = most.shape[1], int((most[0] > RARE_BEYOND * widest).sum())
    drawn = links * (1 + (len(most) - 1) / crowding**2)
    p = float(np.prod((links - np.arange(beyond)) / (drawn - np.arange(beyond))))
    return p, float(most[0].max(initial=0.0)) / widest if widest > 0 else 0.0


def _most_off(versions: Floats, links: NDArray[np.intp]) -> Floats:
    """Return how far the most deviant row of each link is off in each version: [1 + m, L]."""
    known = np.isfinite(versions).all(axis=0)
    inside, code = versions[:, known], np.unique(links[known], return_inverse=True)[1]
    off = np.abs(inside - np.median(inside, axis=0))
    most = np.zeros((len(versions), int(code.max(initial=-1)) + 1))
    for row, values in zip(most, off, strict=True):
        np.maximum.at(row, code, values)
    return most
