"""How far generated C is from the runtime it was written from, on held-out rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backends.base import Floats
from bench.errors import BenchError


@dataclass(frozen=True)
class Agreement:
    """Of `rows` rows, the share whose results are the same bit by bit, and the largest gap."""

    rows: int
    equal: float
    largest_m: float


def compare(found: Floats, expected: Floats) -> Agreement:
    """Return how two predictions [n] in metres agree."""
    gaps = np.abs(found.astype(np.float64) - expected)
    return Agreement(len(gaps), float(np.mean(found == expected)), float(gaps.max()))


def check(agreement: Agreement, limit_m: float) -> None:
    """Raise BenchError where C is further from the runtime than is promised."""
    if not agreement.largest_m <= limit_m:
        raise BenchError(
            f"the C differs from ONNX Runtime by {agreement.largest_m:.2g} m on held-out rows, "
            f"at most {limit_m:g} m is taken; nothing was written"
        )
