"""What rows of one link have in common, and how far they lie from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import MAD_TO_STD, ROW_OFF_STD, SHORTEST_DETOUR_M

Floats = NDArray[np.float64]


def link_medians(values: Floats, code: NDArray[np.intp]) -> Floats:
    """Return the median over the rows of each link, [v, L], of values [v, n]."""
    order = np.argsort(code, kind="stable")
    parts = np.split(values[:, order], np.flatnonzero(np.diff(code[order])) + 1, axis=1)
    return np.stack([np.nanmedian(part, axis=1) for part in parts], axis=1)


def rows_off(ensemble: Ensemble) -> float:
    """Return the share of the rows that lie off their own link by as much as a detour does.

    A blocked path stays blocked: all rows of a link are struck alike. Of links of three rows.
    """
    code = np.unique(ensemble.links, return_inverse=True)[1]
    several = (np.bincount(code) > 2)[code]
    left = ensemble.residual_of(RANGE)
    off = np.abs(left - link_medians(left[None], code)[0][code])[several]
    if not len(off):
        return 0.0
    within = MAD_TO_STD * float(np.nanmedian(off))
    return float(np.mean(off > max(ROW_OFF_STD * within, SHORTEST_DETOUR_M / 2)))
