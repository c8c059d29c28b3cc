"""Combs of devices: each may round to steps of its own, or count them from an end of its own.

Ranges of all devices together then lie on no grid, but those of each do, without any scatter; or
those of one alone, whose firmware is an older one.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.comb import EXACT, STEPS_M, Comb, comb
from bench.physics.units import Floats

ENDS = ("tx", "rx")
FEWEST = 6  # ranges of a device that differ: of fewer any lie on some grid
GRID_NATS = 20.0  # against ranges on a grid by chance: of some 1 000 steps and 40 devices, 1e-4
LEAST_PRINT_M = 1e-6  # less is how numbers are stored
POINT_NATS = 3.5  # of a range, at most: coherent ones lie within 1.5 % of a step of its points


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
        if found and _coarse(found) > _coarse(best[1]):
            best = end, found
    return best


def _coarse(found: dict[str, Comb]) -> float:
    """Return the mean square of the steps of grids, 0 without any."""
    return sum(one.step_m**2 for one in found.values()) / max(len(found), 1)


def _of_end(
    names: NDArray[np.object_], measured_m: Floats, plain_m: Floats, links: NDArray[np.intp]
) -> dict[str, Comb]:
    """Return the grids that all ranges of devices lie on, by device; those without are left out."""
    mine = {str(name): names == name for name in np.unique(names)}
    print_m = _print_m(measured_m)
    made = {n: _of_device(measured_m[m], plain_m[m], links[m], print_m) for n, m in mine.items()}
    return {name: grid for name, grid in made.items() if grid is not None}


def _print_m(measured_m: Floats) -> float:
    """Return what ranges [n] of all devices differ by at least, as they are printed, in metres."""
    gaps = np.diff(np.unique(measured_m))
    return float(gaps[gaps > LEAST_PRINT_M].min(initial=STEPS_M[1]))


def _of_device(
    measured_m: Floats, plain_m: Floats, links: NDArray[np.intp], print_m: float
) -> Comb | None:
    """Return the grid that all ranges [n] of one device lie on, None without one.

    Of ranges that are printed to centimetres one in five lies on a grid of five by chance.
    """
    differ = len(np.unique(measured_m))
    if differ < FEWEST:
        return None
    grid = comb(measured_m, plain_m, np.unique(links, return_inverse=True)[1])
    if grid is None or grid.coherence <= EXACT[0]:
        return None
    each = min(float(np.log(max(grid.step_m / print_m, 1.0))), POINT_NATS)
    return grid if (differ - 1) * each > GRID_NATS else None
