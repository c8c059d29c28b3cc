"""The training rows that backends measure on."""

from __future__ import annotations

import numpy as np

from backends.base import Floats, TrainingData

ROWS = 1024


def sample_rows(data: TrainingData) -> Floats:
    """Return at most `ROWS` training CIRs [n, width], drawn with the data's seed."""
    if len(data.cirs) <= ROWS:
        return data.cirs
    generator = np.random.default_rng(data.seed)
    chosen = np.sort(generator.choice(len(data.cirs), ROWS, replace=False))
    return data.cirs[chosen]
