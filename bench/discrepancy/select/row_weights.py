"""How much ranges of weak signals scatter more: they tell less.

Noise moves an edge by the noise over its slope, so the variance of a range has a part that falls as
the power of the signal (the bound of Cramer and Rao; Dardari et al., Proc. IEEE 97, 2009). A mean
that is off in a few weak rows which scatter anyway is no law of the level.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.grouped import group_means
from bench.discrepancy.select.settings import NOISE_PARTS, SCATTER_OUTLIER, SCATTER_PART_NATS
from bench.discrepancy.select.within_links import link_medians
from bench.discrepancy.settings import MAD_TO_STD
from bench.physics.units import Floats


def row_weights(left_m: Floats, level_db: Floats, links: NDArray[np.intp]) -> Floats:
    """Return by how much rows [n] count, about one: the less, the more such rows scatter.

    From how residual ranges [n] of a link differ from its mean, at its mean level: what links have
    in common may be a cause. All ones where no link has several rows; where levels are not known
    all but what is far off its link.
    """
    where = np.unique(links, return_inverse=True)[1]
    count = np.bincount(where)[where]
    several = count > 1
    if not several.any():
        return np.ones(len(left_m))
    near = _near(left_m, where, several)
    if not np.isfinite(level_db).all():
        return near
    return near * _by_level(left_m, level_db, where, count)


def _near(left_m: Floats, where: NDArray[np.intp], several: NDArray[np.bool_]) -> Floats:
    """Return one for rows [n] near the median of their link, less for those far off it."""
    off = np.abs(left_m - link_medians(left_m[None], where)[0, where])
    most = SCATTER_OUTLIER * MAD_TO_STD * float(np.median(off[several]))
    return np.asarray(np.minimum(1.0, most / np.maximum(off, max(most, 1e-9))))


def _by_level(
    left_m: Floats, level_db: Floats, where: NDArray[np.intp], count: NDArray[np.intp]
) -> Floats:
    """Return by how much rows [n], of links of `count` [n], count by their level, about one."""
    several = count > 1
    off = left_m - group_means(left_m[:, None], where)[:, 0]
    most = SCATTER_OUTLIER * MAD_TO_STD * float(np.median(np.abs(off[several])))
    squares = np.clip(off[several], -most, most) ** 2
    weaker = 10 ** ((np.median(level_db) - level_db) / 10)
    free = 1 - 1 / count[several]  # of the freedom of a row, that its link's mean leaves
    part = _noise_part(squares, weaker[several], free)
    wide = np.sqrt(1 + part * weaker)
    return np.asarray(np.median(wide) / wide)


def _noise_part(squares: Floats, weaker: Floats, free: Floats) -> float:
    """Return the variance that goes with the noise over the power, in the constant part's size.

    The likeliest of some, none where none is worth its price; `free` [n] is the freedom of squares.
    """
    nats = {part: _log_likelihood(squares, 1 + part * weaker, free) for part in NOISE_PARTS}
    best = max(nats, key=lambda part: nats[part])
    return best if nats[best] > nats[0.0] + SCATTER_PART_NATS else 0.0


def _log_likelihood(squares: Floats, shape: Floats, free: Floats) -> float:
    """Return the log likelihood of squares [n] of normal rows of some shape, at the best size."""
    size = float((squares / shape).sum() / free.sum())
    return float(-0.5 * (free * np.log(max(size, 1e-12) * shape)).sum())
