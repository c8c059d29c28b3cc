"""Multipliers as integers, for processors without floating point."""

from __future__ import annotations

import math
from collections.abc import Sequence

BITS = 31  # with 20 only three quarters of REMnet's rows stay equal to the runtime's


def fixed(ratios: Sequence[float]) -> tuple[list[int], int]:
    """Return whole numbers and a shift: ratio = whole / 2^shift, the largest below 2^31.

    Raises ValueError for ratios that are not positive, or that no shift of 2 to 62 suits.
    """
    largest = max(ratios)
    if min(ratios) <= 0 or not math.isfinite(largest):
        raise ValueError(f"scales in the ratio {min(ratios):g}: expected positive numbers")
    shift = BITS - math.frexp(largest)[1]
    whole = [round(ratio * 2.0**shift) for ratio in ratios]
    if max(whole) >= 1 << BITS:
        shift -= 1
        whole = [round(ratio * 2.0**shift) for ratio in ratios]
    if not 2 <= shift <= 62:
        raise ValueError(f"scales in the ratio {largest:g} are out of the range of integers")
    return whole, shift
