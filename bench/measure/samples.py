"""What raw timing samples say: which to drop, order statistics, a warning where they say little."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtr

from bench.results import Latency

FEWEST_ROUNDS = 6  # fewer give no 95 % interval: 1 - 2 x 0.5^5 = 94 %
WIDE, DRIFTED = 0.10, 0.05
SHARED = 0.97  # of its core's time; the rest went to other processes
SLOWED = 1.10  # a figure, times its quiet level
REFERENCE_SLOWED = 1.05  # a core beside that is busy slows it a third as much as a network
LEVEL = 25  # percentile taken for quiet: not the luckiest moment, not a slow one


@dataclass(frozen=True)
class Round:
    """The samples of one round and batch, and what disturbed them.

    `samples_us` are means over the calibrated calls; `reference_us` are the times of the reference
    loop just before and after; `core_share` is processor time over time passed; `others` is how
    many cores other work used meanwhile, less what it may use, so positive means busy.
    """

    samples_us: Sequence[float]
    reference_us: tuple[float, float]
    core_share: float = 1.0
    others: float = 0.0

    @property
    def figure_us(self) -> float:
        """The median sample."""
        return float(np.median(self.samples_us))

    @property
    def ratio(self) -> float:
        """The median sample over the mean of the reference loops beside it."""
        return self.figure_us / float(np.mean(self.reference_us))


def reference_level(rounds: Sequence[Round]) -> float:
    """Return the reference loop's quiet level in microseconds: its lower quartile."""
    return float(np.percentile([one.reference_us for one in rounds], LEVEL))


def undisturbed(rounds: Sequence[Round], level_us: float) -> list[Round]:
    """Return the rounds that nothing else disturbed.

    Dropped are those in which the loop had less than 97 % of its core, or other work used too
    much of the machine; and of the others those that were visibly slowed in both: the reference
    loop before or after by more than 5 % of its level `level_us`, and the round's own figure by
    more than 10 % of the lower quartile of all. A reference that is slow beside a figure as usual
    says nothing of the figure, and a slow figure beside a quick reference is the model's own; both
    stay, and widen the interval.
    """
    alone = [one for one in rounds if one.core_share >= SHARED and one.others <= 0]
    if not alone:
        return []
    usual_us = float(np.percentile([one.figure_us for one in alone], LEVEL))
    return [one for one in alone if not _slowed(one, level_us, usual_us)]


def _slowed(one: Round, level_us: float, usual_us: float) -> bool:
    slow = max(one.reference_us) > REFERENCE_SLOWED * level_us
    return slow and one.figure_us > SLOWED * usual_us


def summarise(batch: int, rounds: Sequence[Round]) -> Latency:
    """Return the statistics of at least 6 rounds.

    Median, p95 and p99 are over all samples. The interval of the median is between two order
    statistics of the ROUND medians (`median_ranks`), because samples of one round share what the
    machine was doing then. `unstable` is set where that interval is wider than 10 % of the median
    (spread), where the medians of the first and the last half of the rounds differ by more
    than 5 % (drift), or where the quickest tenth of the samples is more than 10 % below the median
    (most rounds were slowed alike, as by a neighbour on the same core).
    `reference_ratio` is the median over rounds of sample over reference.
    """
    samples = np.asarray([one.samples_us for one in rounds], np.float64)
    median = float(np.median(samples))
    low, high = median_interval(np.median(samples, axis=1))
    half = len(samples) // 2
    drift = abs(float(np.median(samples[-half:]) - np.median(samples[:half])))
    p10, p95, p99 = np.percentile(samples, [10, 95, 99])
    slowed = median - p10 > WIDE * median
    return Latency(
        batch=batch,
        median_us=median,
        low_us=min(low, median),
        high_us=max(high, median),
        p95_us=float(p95),
        p99_us=float(p99),
        unstable=bool(slowed or high - low > WIDE * median or drift > DRIFTED * median),
        samples_us=[round(float(sample), 4) for sample in samples.ravel()],
        reference_ratio=float(np.median([one.ratio for one in rounds])),
    )


def width(rounds: Sequence[Round]) -> float:
    """Return how wide the 95 % interval of the median of at least 6 rounds is, over the median."""
    medians = np.asarray([np.median(one.samples_us) for one in rounds], np.float64)
    low, high = median_interval(medians)
    return (high - low) / float(np.median(medians))


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
