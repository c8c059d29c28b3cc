"""The noise in front of a channel impulse response."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

NOISE_MARGIN = 64  # samples before the first path that may already hold signal


def noise_std(cir: NDArray[np.float32], first_path: float) -> float:
    """Return the standard deviation of the magnitude well before the first path, in counts.

    NaN where fewer than 64 samples lie there, or the first path is not known.
    """
    quiet = cir[: max(0, int(first_path) - NOISE_MARGIN)] if np.isfinite(first_path) else cir[:0]
    return float(quiet.std()) if len(quiet) > NOISE_MARGIN else float("nan")
