"""Two-way ranging from the six timestamps of an exchange.

The initiator A sends the poll at T1; the responder B receives it at T2 and answers at T3; A
receives that at T4 and sends the final at T5; B receives it at T6. T1, T4, T5 are counts of A's
clock, T2, T3, T6 of B's: 40-bit counters with a tick of 1/(128 x 499.2 MHz) = 15.65 ps, which turn
over every 17.2 s. R_a = T4 - T1, D_b = T3 - T2, R_b = T6 - T3, D_a = T5 - T4, each modulo 2^40.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from bench.errors import BenchError

TICK_S = 1.0 / (128 * 499.2e6)
SPEED_OF_LIGHT_M_PER_S = 299_792_458.0
COUNTER_BITS = 40
COUNTER_TURN_S = 2**COUNTER_BITS * TICK_S
TIMESTAMPS = ("T1", "T2", "T3", "T4", "T5", "T6")
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Intervals:
    """The four intervals [n] of an exchange, in ticks: two round trips, two replies."""

    round_a: Floats
    reply_b: Floats
    round_b: Floats
    reply_a: Floats

    def double_sided_m(self) -> Floats:
        """Return the asymmetric double-sided range in metres; a clock offset nearly cancels.

        (R_a R_b - D_a D_b) / (R_a + R_b + D_a + D_b), written as differences of nearly equal
        numbers so that no digit is lost: the products have 2^66, a double only 53 bits.
        """
        total = self.round_a + self.round_b + self.reply_a + self.reply_b
        excess_a, excess_b = self.round_a - self.reply_b, self.round_b - self.reply_a
        ticks = (excess_a * self.round_b + self.reply_b * excess_b) / total
        return ticks * TICK_S * SPEED_OF_LIGHT_M_PER_S

    def single_sided_m(self) -> Floats:
        """Return the single-sided range (R_a - D_b)/2 in metres.

        It is off by c/2 x reply time x `clock_offset_ppm`: 0.15 m per ppm and millisecond.
        """
        ticks = (self.round_a - self.reply_b) / 2
        return ticks * TICK_S * SPEED_OF_LIGHT_M_PER_S

    def clock_offset_ppm(self) -> Floats:
        """Return by how much A's clock runs fast against B's, in ppm.

        Positive: A counts more ticks than B in the same time, and single-sided ranges read long.
        """
        there_and_back = 2 * self.double_sided_m() / (TICK_S * SPEED_OF_LIGHT_M_PER_S)
        return (self.round_a - there_and_back - self.reply_b) / self.reply_b * 1e6

    def reply_time_s(self) -> Floats:
        """Return B's reply time in seconds of its own clock."""
        return self.reply_b * TICK_S


def intervals(frame: pd.DataFrame) -> Intervals:
    """Return the intervals of a table with columns `T1`..`T6` in ticks; NaN where one is null.

    Raises BenchError naming the first of these columns that is missing.
    """
    for name in TIMESTAMPS:
        if name not in frame:
            raise BenchError(f"no column {name!r}; expected the timestamps T1 .. T6 in ticks")
    t1, t2, t3, t4, t5, t6 = (frame[name].to_numpy(np.float64) for name in TIMESTAMPS)
    return Intervals(elapsed(t1, t4), elapsed(t2, t3), elapsed(t3, t6), elapsed(t4, t5))


def elapsed(start: ArrayLike, end: ArrayLike, bits: int = COUNTER_BITS) -> Floats:
    """Return `end` - `start` in ticks of a counter of so many bits that may have turned over."""
    difference = np.asarray(end, np.float64) - np.asarray(start, np.float64)
    return np.mod(difference, 2.0**bits)
