"""The ground's reflection from first principles: what a fade does to the range.

The reflection arrives `excess` metres after the direct path, far inside the pulse. The sum of both
is, to first order in excess / pulse length, one pulse of complex amplitude 1 + A delayed by
Re(excess x A / (1 + A)), where A = -a exp(-j 2 pi excess / wavelength). |1 + A| is seen in the
received level, a follows from Fresnel's coefficient, so no phase is needed:

    shift = excess x (1/2 - (1 - a^2) / (2 |1 + A|^2))

In a null (|1 + A| = 1 - a) ranges shorten by a / (1 - a) times the excess.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
PERMITTIVITY = 5.24  # concrete, ITU-R P.2040; dry to medium ground has 3 to 15 (ITU-R P.527)


def excess_m(range_m: Floats, height_m: Floats, other_m: Floats) -> Floats:
    """Return by how much the reflected path is longer [n], heights above flat ground."""
    flat = np.sqrt(np.maximum(range_m**2 - (height_m - other_m) ** 2, 0.0))
    return np.asarray(np.hypot(flat, height_m + other_m) - range_m)


def reflected(
    range_m: Floats, height_m: Floats, other_m: Floats, permittivity: float, vertical: bool
) -> Floats:
    """Return the amplitude of the reflection [n], the direct path's being 1 (Fresnel)."""
    longer = range_m + excess_m(range_m, height_m, other_m)
    sine = (height_m + other_m) / longer
    root = np.sqrt(permittivity - (1 - sine**2))
    near = permittivity * sine if vertical else sine
    return np.asarray(np.abs((near - root) / (near + root)) * range_m / longer)


def gain_of_sum(level_dbm: Floats, range_m: Floats, amplitude: Floats) -> Floats:
    """Return |1 + A|^2 [n] from true levels, kept within what two paths can give.

    Over the fringes the mean of |1 + A|^2 is 1 + a^2, which gives the level of the direct path.
    """
    flat = 10 ** (level_dbm / 10) * range_m**2
    direct = np.nanmean(flat / (1 + amplitude**2))
    return np.clip(flat / direct, (1 - amplitude) ** 2, (1 + amplitude) ** 2)


def shift_m(excess: Floats, amplitude: Floats, gain: Floats) -> Floats:
    """Return by how much the reflection inside the pulse lengthens ranges [n] in metres."""
    return np.asarray(excess * (0.5 - (1 - amplitude**2) / (2 * gain)))
