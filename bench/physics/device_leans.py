"""Ways of rounding of devices: one firmware cuts down to a grid, another goes to the nearest point.

Ranges of all devices lie on one grid then, but those of some are off by half a step in the mean,
which is no delay of theirs.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.device_combs import ENDS
from bench.physics.units import Floats

LEANS = (0.0, -0.5, 0.5)  # of a step: to the nearest point, down, up
LEAN_STEPS = 0.1  # off, at most: other causes move the mean as well
MEDIAN_ERROR = 2 * 1.2533 * 1.4826  # two standard errors of a median, of the median deviation


def middle_of(off_steps: Floats, links: NDArray[np.intp]) -> tuple[float, float]:
    """Return the median over links of what ranges [n] are off by, and two errors of it."""
    codes = np.unique(links, return_inverse=True)[1]
    mean = np.bincount(codes, off_steps) / np.bincount(codes)
    middle = float(np.median(mean))
    scatter = float(np.median(np.abs(mean - middle)))
    return middle, MEDIAN_ERROR * scatter / float(np.sqrt(len(mean)))


def device_leans(
    frame: pd.DataFrame, off_steps: Floats, links: NDArray[np.intp]
) -> tuple[str, dict[str, float]]:
    """Return at which end devices lean in two ways, and the lean of each; ("", {}) where in one.

    `off_steps` [n]: recorded ranges less those without rounding, in steps; `links` [n]: codes. Of
    both ends and all pairs of leans those that devices are nearest to.
    """
    best, left = ("", dict[str, float]()), np.inf
    for end in (one for one in ENDS if one in frame):
        names = frame[end].astype(str).to_numpy(object)
        every, counts = np.unique(names, return_counts=True)
        middle = np.array([middle_of(off_steps[names == n], links[names == n])[0] for n in every])
        for able in (*combinations(LEANS, 1), *combinations(LEANS, 2)):
            own = _nearest(middle, np.array(able))
            if (far := float(counts @ (middle - own) ** 2)) < left:
                best, left = (end, dict(zip(map(str, every), own.tolist(), strict=True))), far
    return best if len(set(best[1].values())) > 1 else ("", {})


def _nearest(values: Floats, able: Floats) -> Floats:
    """Return, for each of some values [n], the nearest that is able [k]."""
    return np.asarray(able[np.abs(values[:, None] - able).argmin(axis=1)])


def choice_nats(devices: int) -> float:
    """Return what it costs to choose a lean for each of some devices: of two, of three pairs."""
    return devices * float(np.log(2)) + float(np.log(len(LEANS))) if devices else 0.0
