"""By how much similar links differ beyond versions of one link, and what effects change of that.

A table that has a link several times has drawn what such a link has by chance only once, so links
are off as similar ones differ. Effects change how much: what fills the delays at which nothing
arrives makes links more alike. Were they taken to differ as without it, it would look likely for
taking differences away that recorded links have.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble, stack
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.settings import APART_MOST, SIMILAR

if TYPE_CHECKING:
    from bench.discrepancy.joint.statistics import Statistics

Floats = NDArray[np.float64]


def beyond_own(given: Statistics, added: Added, values: Floats) -> Floats | None:
    """Return by what variance [p] similar links differ beyond versions of one, with effects.

    `values` [1 + m, n, p] are of the recorded rows and of their own versions. None where unknown.
    """
    made = _similar(given, added)
    if made is None or not set(given.names) <= set(made.names):
        return None
    own, others = (
        np.stack([given.of_links(np.nan_to_num(one)) for one in versions[1:]])
        for versions in (values, given.values(made))
    )
    return variance_beyond(own, others)


def _similar(given: Statistics, added: Added) -> Ensemble | None:
    """Return some versions of similar links with effects, None where there are none."""
    comparison, rows = given.comparison, given.rows
    if not isinstance(comparison, TableComparison):
        return None
    own = comparison.distinct(rows)
    picks = comparison.versions(rows)[own : own + SIMILAR]
    numbers = range(own, own + len(picks))
    made = comparison.of_waveforms(rows, picks, (*given.beside, *added), numbers)
    return stack(rows.recorded, made, rows.links) if made else None


def variance_beyond(own: Floats, others: Floats) -> Floats:
    """Return by what variance [p] `others` [v, L, p] differ beyond versions of one link [m, L, p].

    From the mean of these.
    """
    mean, members = own.mean(axis=0), len(own)
    usual = ((own - mean) ** 2).mean(axis=(0, 1)) * (members + 1) / max(members - 1, 1)
    return np.asarray(((others - mean) ** 2).mean(axis=(0, 1)) - usual)


def covariance_beyond(others: Floats, usual: Floats) -> Floats:
    """Return the covariance [p, p] of what others leave [v, L, p] beyond the `usual` [p, p]."""
    wide = np.einsum("vli,vlj->ij", others, others) / others[..., 0].size
    sizes, ways = np.linalg.eigh(wide - usual)
    return np.asarray((ways * np.maximum(sizes, 0)) @ ways.T)


def scaled(covariance: Floats, before: Floats, after: Floats | None) -> Floats:
    """Return a covariance [p, p] as effects change its variances [p], `before` and `after`."""
    if after is None:
        return covariance
    ratio = np.where(before > 0, after / np.where(before > 0, before, 1.0), 1.0)
    size = np.clip(np.sqrt(np.maximum(ratio, 0)), 1 / APART_MOST, APART_MOST)
    return np.asarray(covariance * size[:, None] * size)
