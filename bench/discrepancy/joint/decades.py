"""Values that are compared by their logarithm: the noise that is logged, say, in any unit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.settings import LEAST_LOGGED, LEAST_UNIT

Floats = NDArray[np.float64]


def decades(values: Floats) -> Floats:
    """Return the decades of values, those next to nothing at a share of the median one."""
    known = values[np.isfinite(values)]
    usual = float(np.median(known)) if len(known) else 1.0
    return np.asarray(np.log10(np.maximum(values, LEAST_LOGGED * max(usual, LEAST_UNIT))))
