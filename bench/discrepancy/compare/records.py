"""The samples themselves: recorded waveforms, and what a comparison has in their place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import Floats, aligned, around

Samples = tuple[Floats, Floats]
"""Magnitudes [n, K] around the first path, NaN outside a record, and their delays in ns [n, K]."""
Record = tuple[Samples, Floats]
"""Samples of rows, and the noise [n] that is logged with them, in counts."""


def recorded_samples(comparison: Comparison, view: View) -> Samples | None:
    """Return the samples of recorded rows in the window that is compared, None without any."""
    if not isinstance(comparison, Resimulation | TableComparison) or "cir" not in view.frame:
        return None
    return aligned(view.frame, comparison.window)


def simulated_samples(
    comparison: Comparison, view: View, added: Added, number: int
) -> Samples | None:
    """Return the samples of one simulated version with effects `added`, None without any.

    `number` is that of the version: the same number gives the same random numbers.
    """
    made = simulated_record(comparison, view, added, number)
    return None if made is None else made[0]


def simulated_record(
    comparison: Comparison, view: View, added: Added, number: int
) -> Record | None:
    """Return `simulated_samples` and the noise [n] that is logged with them, in counts."""
    if not isinstance(comparison, Resimulation | TableComparison):
        return None
    made = comparison.outcome(view, added, number)
    if made.cir is None or made.first_path_index is None:
        return None
    period: NDArray[np.float64] = np.full(len(made), made.sample_period_ns)
    samples = around(made.cir, made.first_path_index, period, comparison.window)
    return samples, np.asarray(made.noise_std, np.float64)
