"""How rows scatter: within a link, and what a whole link keeps. Covariances over observables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True)
class Scatter:
    """Covariances [p, p] in the observables' units squared: of rows in a link, and of links."""

    within: Floats
    between: Floats

    def of_means(self, rows: int) -> Floats:
        """Return the covariance [p, p] of the mean of so many rows of one link."""
        return self.within / rows + self.between

    def plus(self, other: Scatter) -> Scatter:
        """Return the scatter of the sum of two independent ones."""
        return Scatter(self.within + other.within, self.between + other.between)


def components(values: Floats, links: Codes) -> Scatter:
    """Return the scatter of values [n, p] of known mean zero; analysis of variance.

    With one row for each link the two cannot be told apart: all is within.
    """
    counts, means = link_means(values, links)
    rows, number = len(values), len(counts)
    left = values - means[links]
    if rows == number:
        return Scatter(values.T @ values / rows, np.zeros((values.shape[1],) * 2))
    within = left.T @ left / (rows - number)
    spread = (means * counts[:, None]).T @ means / rows  # about zero: no mean was fitted
    return Scatter(within, positive(spread - within * number / rows))


def link_means(values: Floats, links: Codes) -> tuple[Floats, Floats]:
    """Return row counts [L] and means [L, p] of the links 0..L-1."""
    counts = np.bincount(links).astype(np.float64)
    sums = np.stack([np.bincount(links, column) for column in values.T], axis=1)
    return counts, np.asarray(sums / counts[:, None])


def beyond(seen: Scatter, simulated: Scatter, least: Floats) -> Scatter:
    """Return what is seen beyond what is simulated; `least` [p] stds within a link at least."""
    within = positive(seen.within - simulated.within) + np.diag(least**2)
    return Scatter(within, positive(seen.between - simulated.between))


def positive(matrix: Floats) -> Floats:
    """Return the nearest symmetric matrix without negative variances."""
    roots = np.linalg.eigh((matrix + matrix.T) / 2)
    return np.asarray(
        (roots.eigenvectors * np.maximum(roots.eigenvalues, 0)) @ roots.eigenvectors.T
    )


def log_likelihood(residual: Floats, links: Codes, scatter: Scatter) -> float:
    """Return the normal log likelihood of residuals [n, p], constants left out."""
    counts, means = link_means(residual, links)
    left = residual - means[links]
    inside = np.einsum("np,pq,nq->", left, np.linalg.inv(scatter.within), left)
    inside += (len(residual) - len(counts)) * np.linalg.slogdet(scatter.within)[1]
    total = scatter.within + counts[:, None, None] * scatter.between
    solved = np.linalg.solve(total, means[..., None])[..., 0]
    outside = (counts * np.einsum("lp,lp->l", means, solved)).sum()
    outside += np.linalg.slogdet(total)[1].sum()
    return float(-(inside + outside) / 2)
