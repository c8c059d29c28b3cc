"""What effects draw by chance: how it moves the statistics of a link together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.grouped import group_sums
from bench.discrepancy.joint.covariances import Covariances
from bench.discrepancy.joint.settings import LEAST_VARIANCE, SAME_SCATTER

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


def with_drawn(
    plain: Mapping[int, Floats],
    whole: Mapping[int, Floats],
    change: Floats,
    code: Codes,
    level: int,
) -> Mapping[int, Floats]:
    """Return `plain` covariances and what effects change by chance, `whole` where that is not all.

    `change` [m, n, p]: what effects do to rows of m versions, each drawn anew; `code` [n] tells
    their links. What is drawn once for a link moves all statistics along one way: shrunk to its
    diagonal it would move each by itself, and a reflection of chance phase would ask for scatter
    that no link has. What goes with the statistic at place `level` is shrunk all the same: scatter
    of levels alone would stand for any form of a loss. How far each scatters `whole` says: an
    effect may drown what is there. Where it takes much of that away, it is no sum, and in between
    (see `SAME_SCATTER`) partly one: fits go by small steps.
    """
    if not (isinstance(plain, Covariances) and isinstance(whole, Covariances)) or len(change) < 2:
        return whole
    made = _with(plain, *_drawn(change, code), level)
    ratio = _sizes(whole.every) / np.maximum(_sizes(made.every), LEAST_VARIANCE)
    off = float(np.abs(np.log(np.maximum(ratio, LEAST_VARIANCE))).max())
    share = float(np.interp(off, SAME_SCATTER, (1.0, 0.0)))
    if not share:
        return whole
    return replace(made, scaled=np.sqrt(ratio), sum_share=share, whole=whole.every)


def _with(plain: Covariances, link: Floats, rows: Floats, level: int) -> Covariances:
    """Return covariances with those [p, p] of what is drawn for links and rows."""
    of_level = _going_with(link, level), _going_with(rows, level)
    return replace(
        plain,
        link=plain.link + of_level[0],
        rows=plain.rows + of_level[1],
        changed_link=link - of_level[0],
        changed_rows=rows - of_level[1],
    )


def _drawn(change: Floats, code: Codes) -> tuple[Floats, Floats]:
    """Return the covariances [p, p] of what versions [m, n, p] draw for links, and for rows."""
    members, count = len(change), np.bincount(code)
    own = (change - change.mean(axis=0)) * np.sqrt(members / (members - 1))
    of_links = np.stack([group_sums(one, code, len(count)) / count[:, None] for one in own])
    rows = of_rows(own - of_links[:, code], len(count))
    return of_means(of_links) - rows * float(np.mean(1 / count)), rows


def of_means(of_links: Floats) -> Floats:
    """Return the covariance [p, p] of what means of links have by chance [m, L, p]."""
    return np.asarray(np.einsum("mli,mlj->ij", of_links, of_links) / of_links[..., 0].size)


def of_rows(within: Floats, links: int) -> Floats:
    """Return the covariance [p, p] of rows [m, n, p] about the mean of their link, of so many."""
    loose = within.shape[1] - links
    rows = np.einsum("mni,mnj->ij", within, within) / max(loose * len(within), 1)
    return np.asarray(rows if loose else np.zeros_like(rows))


def _going_with(covariance: Floats, place: int) -> Floats:
    """Return that part of a covariance [p, p] which goes with the statistic at a place."""
    own = max(float(covariance[place, place]), LEAST_VARIANCE)
    return np.asarray(np.outer(covariance[place], covariance[place]) / own)


def _sizes(covariances: Floats) -> Floats:
    """Return the variances [c, p] of covariances [c, p, p]."""
    return np.asarray(np.diagonal(covariances, axis1=-2, axis2=-1))
