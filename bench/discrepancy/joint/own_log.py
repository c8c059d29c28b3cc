"""What the log of noise is of: how much noise scatters, or, in another tool's table, its power.

Simulated rows say: their noise has no tone, and its log is 0.46 of the root of mean squares of
magnitudes where it is their scatter, as where a simulator is run again, 0.71 where it is that of
one component, and 1 where it is that root itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.discrepancy.compare.records import Record
from bench.discrepancy.data.observables import NOISE
from bench.discrepancy.joint.quiet_moments import early_samples, error_of, log_moments, ratio_of
from bench.discrepancy.joint.settings import MEMBERS, SCATTER_LOGGED
from bench.discrepancy.joint.statistics import Floats, Statistics


def logs_scatter(given: Statistics, bare: Sequence[Record]) -> bool:
    """Return whether it is logged how much noise scatters, as far as simulated rows say.

    `bare` are versions of these. Not where too few rows have a log.
    """
    if NOISE not in given.names:
        return False
    every = [
        log_moments(magnitude[:, early_samples(delay)], logged)
        for (magnitude, delay), logged in bare[:MEMBERS]
    ]
    return bool(every) and of_scatter(np.unique(np.concatenate(every), axis=0))


def of_scatter(moments: Floats) -> bool:
    """Return whether rows of such `log_moments` [n, 2] log how much noise scatters."""
    if np.count_nonzero(moments[:, 1]) < 2:
        return False
    return bool(abs(ratio_of(moments) - 1) + 2 * error_of(moments) < SCATTER_LOGGED)
