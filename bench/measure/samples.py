"""What raw timing samples say: order statistics, and a warning where they say little."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtr

from bench.results import Latency

FEWEST_ROUNDS = 6  # fewer give no 95 % interval: 1 - 2 x 0.5^5 = 94 %
WIDE, DRIFTED, SHARED = 0.10, 0.05, 0.95


def summarise(
    batch: int, rounds_us: Sequence[Sequence[float]], core_shares: Sequence[float]
) -> Latency:
    """Return the statistics of samples [rounds, samples] in microseconds.

    Median, p95 and p99 are over all samples. The interval of the median is between two order
    statistics of the ROUND medians (`median_ranks`), because samples of one round share what the
    machine was doing then. `unstable` is set where that interval is wider than 10 % of the median
    (spread), where the medians of the first and the last half of the rounds differ by more than
    5 % (drift), or where in the middle round of `core_shares` [rounds] other processes had the
    core for more than 5 % of the time (load).
    """
    samples = np.asarray(rounds_us, np.float64)
    median = float(np.median(samples))
    low, high = median_interval(np.median(samples, axis=1))
    half = len(samples) // 2
    drift = abs(float(np.median(samples[-half:]) - np.median(samples[:half])))
    p95, p99 = np.percentile(samples, [95, 99])
    return Latency(
        batch=batch,
        median_us=median,
        low_us=min(low, median),
        high_us=max(high, median),
        p95_us=float(p95),
        p99_us=float(p99),
        unstable=bool(
            high - low > WIDE * median
            or drift > DRIFTED * median
            or np.median(core_shares) < SHARED
        ),
        samples_us=[round(float(sample), 4) for sample in samples.ravel()],
    )


def median_interval(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return the 95 % order-statistic interval of the median of at least 6 values."""
    rank = median_rank(len(values))
    ordered = np.sort(values)
    return float(ordered[rank - 1]), float(ordered[len(values) - rank])


def median_rank(count: int) -> int:
    """Return r such that the r-th smallest and r-th largest of `count` enclose the median.

    The largest r with P(Binomial(count, 1/2) < r) <= 2.5 % (Conover, "Practical Nonparametric
    Statistics", section 3.2): the interval covers the median at least 95 % of the time, whatever
    the distribution.
    """
    ranks = np.arange(count + 1)
    return max(1, int(np.count_nonzero(bdtr(ranks, count, 0.5) <= 0.025)))
