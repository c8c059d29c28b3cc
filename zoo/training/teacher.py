"""What a network learns that another one teaches."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from zoo.base import Floats, Progress
from zoo.remnet import REMnet


def word_of(
    teacher: REMnet, cirs: Floats, errors_m: Floats, progress: Progress | None = None
) -> Floats:
    """Fit a teacher on CIRs [n, width] and errors [n] in metres; return what it says of them [n].

    Of CIRs that are narrower than it reads it takes all that there is.
    """
    if teacher.cir_samples is not None and cirs.shape[1] < teacher.cir_samples:
        teacher.set_params(cir_samples=None)
    said: Floats = teacher.fit(cirs, errors_m, progress=progress).predict(cirs)
    return said


def taught(errors_m: ArrayLike, said_m: ArrayLike) -> NDArray[np.float32]:
    """Return what a taught network learns [n]: halfway between the error and the teacher's word."""
    halfway: NDArray[np.float32] = (0.5 * (np.asarray(errors_m) + np.asarray(said_m))).astype(
        np.float32
    )
    return halfway


def half(progress: Progress | None, start: float) -> Progress | None:
    """Return what tells `progress` of one half of the work."""
    return None if progress is None else lambda done: progress(start + 0.5 * done)
