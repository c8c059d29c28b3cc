"""Whether a noise that tables log is a figure of theirs, and not that of their samples.

A simulator may write down the noise that it was asked for. Where both sides log the same though the
samples of one hold much more of it, the log says nothing of what its samples hold: a tone in them
is not refused for being in no log.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import WAVES, numeric
from bench.discrepancy.data.observables import NOISE
from bench.discrepancy.data.settings import LOGS_ALIKE_DB, ROWS_THAT_TELL, SAMPLES_APART_DB
from bench.physics.base import power_of_noise
from bench.physics.own_base import noise_times
from bench.physics.units import decibel


def untrue_logs(tables: Sequence[pd.DataFrame]) -> tuple[str, ...]:
    """Return the column of the noise where a recorded and a simulated table's say nothing of it."""
    return (NOISE,) if len(tables) == 2 and nominal_noise(*tables) else ()


def nominal_noise(recorded: pd.DataFrame, simulated: pd.DataFrame) -> float:
    """Return how many dB more noise recorded samples hold where logs say the same; 0 where not."""
    told = [_told(frame) for frame in (recorded, simulated)]
    if any(one is None for one in told):
        return 0.0
    (ours, times), (theirs, other_times) = [one for one in told if one]
    logged_db, held_db = decibel([ours / theirs, times / other_times]).tolist()
    return held_db if abs(logged_db) < LOGS_ALIKE_DB and abs(held_db) > SAMPLES_APART_DB else 0.0


def _told(frame: pd.DataFrame) -> tuple[float, float] | None:
    """Return the power that is logged, and how many times that samples hold, None if untold."""
    if not {*WAVES, NOISE} <= {*frame} or not len(frame):
        return None
    rows = frame.iloc[np.unique(np.linspace(0, len(frame) - 1, ROWS_THAT_TELL).astype(np.intp))]
    if len({np.size(cell) for cell in rows["cir"]}) != 1:
        return None
    power = power_of_noise(numeric(rows, NOISE))
    known = np.isfinite(power) & (power > 0)
    if not known.any():
        return None
    size = np.abs(np.stack(rows["cir"].to_list()))[known]
    times = noise_times(size, numeric(rows, "first_path_index")[known], power[known])
    return float(np.median(power[known])), times
