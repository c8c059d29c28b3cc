"""What sets of causes say of one of their names: factors of its columns, and how sure they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Believed:
    """What one set says of a name: its `share` of belief, the factors [k] of the name's columns.

    `told` [K, K] is how surely rows tell all factors of the set, `before` [K] how surely they are
    known before, both as inverse variances; `mine` [K] are those of the name.
    """

    share: float
    factors: Floats
    told: Floats
    before: Floats
    mine: NDArray[np.bool_]

    def covariance(self, noise: float = 1.0) -> Floats:
        """Return the covariance [k, k] of the factors, where rows scatter by `noise` times more.

        In variance: what is known before is as sure then.
        """
        whole = np.linalg.inv(self.told / noise + np.diag(self.before))
        return np.asarray(whole[np.ix_(self.mine, self.mine)], np.float64)


@dataclass(frozen=True)
class Unsure:
    """What a name may do to all rows: `columns` [n, k] in metres times the factors of sets.

    The first of `sets` is the one that was chosen; `alone` is what it says if all the others of it
    were known.
    """

    columns: Floats
    sets: tuple[Believed, ...]
    alone: Believed
