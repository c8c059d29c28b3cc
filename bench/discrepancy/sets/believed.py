"""What sets of causes say of one of their names: factors of its columns, and how sure they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Believed:
    """What one set says of a name: its `share` of belief, the factors [k], their covariance."""

    share: float
    factors: Floats
    covariance: Floats


@dataclass(frozen=True)
class Unsure:
    """What a name may do to all rows: `columns` [n, k] in metres times the factors of sets.

    The first of `sets` is the one that was chosen; `alone` is the covariance of its factors if all
    the others of it were known.
    """

    columns: Floats
    sets: tuple[Believed, ...]
    alone: Floats
