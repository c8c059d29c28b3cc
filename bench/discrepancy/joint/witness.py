"""What stands witness that links were struck: struck ones read longer, or their first path is weak.

What is in the way makes ranges longer, where a detector then finds a later path; where it still
finds the straight one, that is weak, and what comes later is as strong as ever.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, rankdata

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import profile_ns
from bench.discrepancy.joint.mixture import Found
from bench.discrepancy.joint.settings import (
    CALM_WIDER,
    FAINT_DB,
    FAINT_ODDS,
    LATER_NS,
    LONGER_M,
    LONGER_ODDS,
    SHORT_OF_STRUCK,
)
from bench.discrepancy.select.within_links import rows_off
from bench.discrepancy.sets.settings import STRAY_LINK_M, STRAY_LINK_STD
from bench.discrepancy.settings import MAD_TO_STD, ROWS_STRUCK_SHARE

Floats = NDArray[np.float64]


def rows_jump(made: Ensemble, struck: NDArray[np.bool_]) -> bool:
    """Return whether rows lie off their links more often than so many struck ones [L] explain.

    Those of the others, which nothing stands before: of a first path that is weak noise decides,
    row by row, how late it is found.
    """
    spared = ~struck[np.unique(made.links, return_inverse=True)[1]]
    return bool(spared.any() and rows_off(made.rows(spared)) > ROWS_STRUCK_SHARE * struck.mean())


def read_long(offset_m: Floats, struck: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which links [L] read longer than the spared ones scatter, struck or not.

    Waveforms find some of the struck ones sooner than others, as what is weak anyway by what else
    stands there, and that is known; ranges tell of all which they are.
    """
    calm = offset_m[~struck & np.isfinite(offset_m)]
    wide = MAD_TO_STD * float(np.median(np.abs(calm - np.median(calm))))
    return np.asarray(offset_m > np.median(calm) + max(LONGER_M, STRAY_LINK_STD * wide))


def is_longer(offset_m: Floats, struck: NDArray[np.bool_]) -> bool:
    """Return whether struck links [L] read longer than the others: nearly all of them, and well."""
    known = np.isfinite(offset_m)
    offset_m, struck = offset_m[known], struck[known]
    hit, calm = offset_m[struck], offset_m[~struck]
    if not len(hit) or not len(calm):
        return False
    ranks = rankdata(offset_m)[struck].sum() - len(hit) * (len(hit) + 1) / 2
    far = float(np.median(hit) - np.median(calm))
    return bool(ranks / (len(hit) * len(calm)) > LONGER_ODDS and far > LONGER_M)


def as_often_short(offset_m: Floats, struck: NDArray[np.bool_]) -> bool:
    """Return whether links [L] read short by far, half as many as are struck.

    Nothing makes a way shorter than a straight one: what moves links both ways obstructs none.
    """
    known = np.isfinite(offset_m)
    offset_m, struck = offset_m[known], struck[known]
    calm = offset_m[~struck] - np.median(offset_m[~struck])
    wide = MAD_TO_STD * float(np.median(np.abs(calm)))
    short = calm < -max(STRAY_LINK_M, STRAY_LINK_STD * wide)
    return bool(short.sum() > SHORT_OF_STRUCK * struck.sum())


def weak_first(found: Found) -> bool:
    """Return whether first paths of struck links are weak beside what comes later.

    Nearly all of them, and well; few others are as much stronger, and these differ by no more than
    simulated ones: else all links fade by chance.
    """
    lead = first_db(found.mixture.given.names, found.mixture.bare.left)
    hit, calm = lead[found.struck], lead[~found.struck]
    if not (np.isfinite(hit).any() and np.isfinite(calm).any()):
        return False
    middle = float(np.nanmedian(calm))
    weaker = middle - float(np.nanmedian(hit))
    odds = float(np.mean(hit[:, None] < calm[None, :]))
    strong = int((calm > middle + weaker / 2).sum())
    sure = weaker >= FAINT_DB and odds > FAINT_ODDS and strong <= SHORT_OF_STRUCK * len(hit)
    return bool(sure and _width(calm) <= CALM_WIDER * _simulated_width(found))


def _simulated_width(found: Found) -> float:
    """Return the standard deviation over simulated links, which nothing struck, of the same."""
    given = found.mixture.given
    every = [first_db(given.names, left) for left in given.others(found.mixture.beside)]
    return float(np.mean([_width(one) for one in every])) if every else 0.0


def _width(values: Floats) -> float:
    """Return the standard deviation of what is known of values, by what nine in ten lie between."""
    low, high = np.nanpercentile(values, (10, 90))
    return float(high - low) / (2 * float(norm.ppf(0.9)))


def first_db(names: Sequence[str], left: Floats) -> Floats:
    """Return by how much first paths of links are stronger than simulated, beside later ones [L].

    In dB, of what statistics with these `names` leave [L, p]; NaN without samples so late.
    """
    bins = {i: ns for i, name in enumerate(names) if (ns := profile_ns(name)) is not None}
    first = [i for i, (low, high) in bins.items() if low < 0 < high]
    later = [i for i, (low, _) in bins.items() if low > LATER_NS]
    if not (first and later):
        return np.full(len(left), np.nan)
    return np.asarray(left[:, first[0]] - np.median(left[:, later], axis=1))
