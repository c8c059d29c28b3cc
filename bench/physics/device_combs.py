"""Combs of devices: each may round to steps of its own, or count them from an end of its own.

Ranges of all devices together then lie on no grid, but those of each do, without any scatter.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.comb import EXACT, Comb, comb
from bench.physics.units import Floats

ENDS = ("tx", "rx")
FEWEST = 12  # ranges of a device that differ: on a grid of any step by chance in one of e^9
MOST = 0.5  # of all rows, that must be of devices with a grid: else it is no firmware's


def device_combs(
    frame: pd.DataFrame, measured_m: Floats, plain_m: Floats, links: NDArray[np.intp]
) -> tuple[str, dict[str, Comb]]:
    """Return at which end devices have grids of their own, and these; ("", {}) without.

    At the end where they are coarser, as those of all lie on what ranges are printed to, too.
    `measured_m`, `plain_m` [n]: recorded ranges, and as they would be without; `links` [n]: codes.
    """
    best: tuple[str, dict[str, Comb]] = "", {}
    for end in (one for one in ENDS if one in frame):
        names = frame[end].astype(str).to_numpy(object)
        found = _of_end(names, measured_m, plain_m, links)
        if len(found) > 1 and _coarse(found) > _coarse(best[1]):
            best = end, found
    return best


def _coarse(found: dict[str, Comb]) -> float:
    """Return the mean square of the steps of grids, 0 without any."""
    return sum(one.step_m**2 for one in found.values()) / max(len(found), 1)


def _of_end(
    names: NDArray[np.object_], measured_m: Floats, plain_m: Floats, links: NDArray[np.intp]
) -> dict[str, Comb]:
    """Return the grids that all ranges of devices lie on, by device; none where few have one."""
    out, without = dict[str, Comb](), 0
    every, counts = np.unique(names, return_counts=True)
    for name in every[np.argsort(-counts, kind="stable")]:
        mine = names == name
        grid = _of_device(measured_m[mine], plain_m[mine], links[mine])
        if grid is not None:
            out[str(name)] = grid
        elif (without := without + int(mine.sum())) >= (1 - MOST) * len(names):
            return {}  # whatever the others have
    return out


def _of_device(measured_m: Floats, plain_m: Floats, links: NDArray[np.intp]) -> Comb | None:
    """Return the grid that all ranges [n] of one device lie on, None without one."""
    if len(np.unique(measured_m)) < FEWEST:
        return None
    grid = comb(measured_m, plain_m, np.unique(links, return_inverse=True)[1])
    return grid if grid is not None and grid.coherence > EXACT[0] else None
