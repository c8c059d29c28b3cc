"""Made-up rows of CIR, levels and range, whose error shows in all three: not a simulation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from zoo.inputs import LEVELS

Floats = NDArray[np.float32]
CIR = 157


def made_up_blocks(
    rows: int, seed: int, links: int = 20
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return rows [n, 157 + 8 + 1], errors [n] in metres and links [n].

    Half the noise figures are unknown, and peak amplitudes all of them.
    """
    rng = np.random.default_rng(seed)
    link = np.sort(rng.integers(0, links, rows))
    blocked = rng.random(links)[link]
    time = np.arange(CIR) - 5.0
    tail = np.where(time >= 0, np.exp(-time / (6 + 25 * blocked[:, None])), 0)
    cir = rng.rayleigh(80, (rows, CIR)) + 12_000 * (1.2 - blocked[:, None]) * tail
    levels = np.full((rows, len(LEVELS)), np.nan)
    levels[:, 0] = -80 - 12 * blocked + rng.normal(0, 0.5, rows)
    levels[:, 1] = levels[:, 0] - 2 - 8 * blocked + rng.normal(0, 0.5, rows)
    levels[: rows // 2, 2] = 80
    levels[:, 3] = 1000
    errors = 0.4 * blocked + rng.normal(0, 0.02, rows)
    distance = rng.uniform(2, 12, rows)
    X = np.column_stack([cir, levels, distance])
    return X.astype(np.float32), errors.astype(np.float32), link
