"""Multipliers as integers, for processors without floating point."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from backends.c.operators import Array

QUICK_SHIFTS = range(33, 43)
QUICK_ERROR = 1 / 300  # below the 1/256 that is looked at again
QUICK_SUM = 1 << 30
BITS = 31  # with 20 only three quarters of REMnet's rows stay equal to the runtime's


def is_quick(sums: Array, ratios: Array, shift: int) -> bool:
    """Tell whether multipliers cut to 20 bits suit sums of these sizes: see `uwb_scaled_quick`.

    What leaves 8 bits twice over may be wrong: it is cut at their ends anyway.
    """
    told = np.minimum(sums, 512.0 / ratios)
    wrong = told.max() * 2.0 ** (11 - shift) + 2.0 ** (23 - shift)
    fits = (sums * ratios).max() * 2.0 ** (shift - 23) < QUICK_SUM
    return shift in QUICK_SHIFTS and bool(fits) and bool(wrong < QUICK_ERROR)


def fixed(ratios: Sequence[float]) -> tuple[list[int], int]:
    """Return whole numbers and a shift: ratio = whole / 2^shift, the largest below 2^31.

    Below 2^-32 a shift of 62 stays: of a sum of 32 bits such a ratio leaves nothing anyway. Raises
    ValueError for ratios that are not positive, or too large for a shift of 2.
    """
    largest = max(ratios)
    if min(ratios) <= 0 or not math.isfinite(largest):
        raise ValueError(f"scales in the ratio {min(ratios):g}: expected positive numbers")
    shift = min(BITS - math.frexp(largest)[1], 62)
    whole = [round(ratio * 2.0**shift) for ratio in ratios]
    if max(whole) >= 1 << BITS:
        shift -= 1
        whole = [round(ratio * 2.0**shift) for ratio in ratios]
    if shift < 2:
        raise ValueError(f"scales in the ratio {largest:g} are out of the range of integers")
    return whole, shift
