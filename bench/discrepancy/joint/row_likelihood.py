"""How likely it is that rows of a link scatter about its mean as they do.

What draws every row anew is told by this from what links keep. What devices differ in comes and
goes (lamps blink), so rows may have more or less of it, each by itself, in all statistics at once:
without that a second cause that draws rows anew would stand for it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.settings import TAIL

if TYPE_CHECKING:
    from bench.discrepancy.joint.statistics import Moments, Statistics

Floats = NDArray[np.float64]


def come_and_gone(
    given: Statistics, moments: Moments, links: Floats | None, rows: Floats | None
) -> Moments:
    """Return statistics of which links and rows have more or less [L, p, k], None as they are."""
    within = moments.within
    as_before = rows is None and moments.uneven_rows is None
    if moments.of_rows is not None and moments.rows is not None and not as_before:
        within = given.within(moments.of_rows, moments.rows, rows)
    return replace(moments, uneven=links, uneven_rows=rows, within=within)


def rows_nats(
    about: Floats, code: NDArray[np.intp], wide: Floats, uneven: Floats | None = None
) -> float:
    """Return the log likelihood of rows `about` the mean of their link [n, p], in nats.

    `code` [n]: the link of every row; `wide` [p, p]: the covariance of rows; `uneven` [L, p, k]: by
    how much rows of a link have more or less of something, each by itself. Rows far off count by
    the logarithm of how far (Student's t).
    """
    square, volume = _off(about, code, wide, uneven)
    share = (1 - 1 / np.bincount(code))[code]  # of a row, that its link's mean leaves
    told = share > 0
    freedom = TAIL + about.shape[1]
    nats = 0.5 * freedom * np.log1p(square[told] / share[told] / TAIL) + volume[told]
    return -float((nats * share[told]).sum())


def _off(
    about: Floats, code: NDArray[np.intp], wide: Floats, uneven: Floats | None
) -> tuple[Floats, Floats]:
    """Return how far rows are off, squared [n], and half the log volume of their scatter [n]."""
    if uneven is None:
        root = np.linalg.cholesky(wide)
        volume = np.full(len(about), np.log(np.diag(root)).sum())
        return (np.linalg.solve(root, about.T) ** 2).sum(axis=0), volume
    root = np.linalg.cholesky(wide + np.einsum("lik,ljk->lij", uneven, uneven))
    volume = np.log(np.einsum("lii->li", root)).sum(axis=1)[code]
    white = np.einsum("nij,nj->ni", np.linalg.inv(root)[code], about)
    return (white**2).sum(axis=1), volume
