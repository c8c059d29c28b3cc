"""How far generated C is from the runtime it was written from, on held-out rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backends.base import Floats
from bench.errors import BenchError


@dataclass(frozen=True)
class Agreement:
    """Of `rows` rows, the share whose results are the same bit by bit, and how far others are.

    99 % of rows are within `usual_m`. A tree, or rounding to 8 bits, turns the last bit of a
    feature into a step now and then, so that a few rows may be further apart: `largest_m`.
    """

    rows: int
    equal: float
    usual_m: float
    largest_m: float


def compare(found: Floats, expected: Floats) -> Agreement:
    """Return how two predictions [n] in metres agree."""
    gaps = np.abs(found.astype(np.float64) - expected)
    usual_m = float(np.quantile(gaps, 0.99, method="higher"))
    return Agreement(len(gaps), float(np.mean(found == expected)), usual_m, float(gaps.max()))


def at_most(gap_m: float) -> str:
    """Return a gap in words, to the thousandth of a millimetre: less means nothing.

    >>> at_most(7.5e-9), at_most(0.0), at_most(6.6e-6)
    ('at most 0.001 mm', 'at most 0 mm', 'at most 0.0066 mm')
    """
    return f"at most {max(gap_m * 1e3, 1e-3 * (gap_m > 0)):.2g} mm"


def check(agreement: Agreement, limit_m: float) -> None:
    """Raise BenchError where C is further from the runtime than is promised."""
    if not agreement.usual_m <= limit_m:
        raise BenchError(
            f"the C differs from ONNX Runtime by {agreement.usual_m:.2g} m on held-out rows (99 % "
            f"are within that), at most {limit_m:g} m is taken; nothing was written"
        )
