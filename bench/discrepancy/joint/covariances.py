"""Covariances of what links leave: those of simulated ones, shrunk, made when they are asked for.

Most sets of effects are simulated for their means alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.settings import LEAST_EIGENVALUE

Floats = NDArray[np.float64]


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
    _made: dict[int, Floats] = field(default_factory=dict, init=False, repr=False)

    def __getitem__(self, count: int) -> Floats:
        if count not in self._made:
            if count not in self.counts:
                raise KeyError(count)
            whole = shrunk(self.link + self.rows / count, self.share)
            self._made[count] = whole * self.wider + self.apart + self.floor
        return self._made[count]

    def __iter__(self) -> Iterator[int]:
        return iter(self.counts)

    def __len__(self) -> int:
        return len(self.counts)


def shrunk(covariance: Floats, share: float) -> Floats:
    """Return a covariance that is shrunk to its diagonal, without negative directions."""
    sizes, ways = np.linalg.eigh((covariance + covariance.T) / 2)
    least = LEAST_EIGENVALUE * max(float(np.median(sizes)), 1e-6)
    whole = (ways * np.maximum(sizes, least)) @ ways.T
    return np.asarray((1 - share) * whole + share * np.diag(np.diag(whole)))
