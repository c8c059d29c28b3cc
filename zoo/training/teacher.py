"""What a network learns that another one teaches."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def taught(errors_m: ArrayLike, said_m: ArrayLike) -> NDArray[np.float32]:
    """Return what a taught network learns [n]: halfway between the error and the teacher's word."""
    halfway: NDArray[np.float32] = (0.5 * (np.asarray(errors_m) + np.asarray(said_m))).astype(
        np.float32
    )
    return halfway
