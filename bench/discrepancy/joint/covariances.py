"""Covariances of what links leave: those of simulated ones, shrunk, made when they are asked for.

Most sets of effects are simulated for their means alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.grouped import means_by_group
from bench.discrepancy.joint.settings import LEAST_EIGENVALUE

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Covariances(Mapping[int, Floats]):
    """The covariance [p, p] of means over so many rows of a link, by that number: of `counts`.

    That of links, `link`, and of rows, `rows` [p, p], shrunk by `share` and made `wider`; `apart`
    [p, p] and `floor` [p, p] are added.
    """

    counts: tuple[int, ...]
    link: Floats
    rows: Floats
    share: float
    wider: float
    apart: Floats
    floor: Floats

    @cached_property
    def every(self) -> Floats:
        """All of them, in the order of `counts` [c, p, p]: at once, as the calls cost most."""
        return self.made()

    def made(self) -> Floats:
        """Return `every`, made."""
        return shrunk(self.over(self.link, self.rows), self.share) * self.wider + self.besides

    @property
    def besides(self) -> Floats:
        """What is added [p, p]."""
        return self.apart + self.floor

    def over(self, link: Floats, rows: Floats) -> Floats:
        """Return covariances of means over so many rows [c, p, p], of links and of rows."""
        return np.stack([link + rows / count for count in self.counts])

    def __getitem__(self, count: int) -> Floats:
        if count not in self.counts:
            raise KeyError(count)
        return np.asarray(self.every[self.counts.index(count)])

    def __iter__(self) -> Iterator[int]:
        return iter(self.counts)

    def __len__(self) -> int:
        return len(self.counts)


def in_parts(own: Floats, code: Codes, count: Codes) -> tuple[Floats, Floats, Floats]:
    """Return covariances [p, p] of links' means and of rows about them, and these rows [m, n, p].

    Of what rows of versions have by chance [m, n, p], whose links, of `count` [L] rows each, `code`
    [n] tells.
    """
    means = np.stack([means_by_group(one, code, count) for one in own])
    about = own - means[:, code]
    return of_means(means), _of_rows(about, len(count)), about


def of_means(of_links: Floats) -> Floats:
    """Return the covariance [p, p] of what means of links have by chance [m, L, p]."""
    return np.asarray(np.einsum("mli,mlj->ij", of_links, of_links) / of_links[..., 0].size)


def _of_rows(within: Floats, links: int) -> Floats:
    """Return the covariance [p, p] of rows [m, n, p] about the mean of their link, of so many."""
    loose = within.shape[1] - links
    rows = np.einsum("mni,mnj->ij", within, within) / max(loose * len(within), 1)
    return np.asarray(rows if loose else np.zeros_like(rows))


def beyond_rows(between: Floats, rows: Floats, count: Codes) -> Floats:
    """Return the covariance [p, p] of links alone: that of their means, less what rows make."""
    return np.asarray(between - rows * float(np.mean(1 / count)))


def shrunk(covariance: Floats, share: float) -> Floats:
    """Return covariances [.., p, p], shrunk to their diagonals, without negative directions."""
    sizes, ways = np.linalg.eigh((covariance + np.swapaxes(covariance, -1, -2)) / 2)
    least = LEAST_EIGENVALUE * np.maximum(np.median(sizes, axis=-1, keepdims=True), 1e-6)
    whole = (ways * np.maximum(sizes, least)[..., None, :]) @ np.swapaxes(ways, -1, -2)
    made, places = (1 - share) * whole, np.arange(whole.shape[-1])
    made[..., places, places] += share * whole[..., places, places]
    return np.asarray(made)
