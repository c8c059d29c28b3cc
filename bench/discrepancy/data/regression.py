"""What a regression leaves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def rest_of(values: Floats, design: Floats) -> Floats:
    """Return what a regression on a design [n, k] leaves of values [n] or [n, m]."""
    return np.asarray(values - design @ np.linalg.lstsq(design, values, rcond=None)[0])
