"""How fast two antennas move apart, from true ranges and times."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

SPEED = "radial_speed_m_per_s"
LONGEST_GAP_S = 2.0
"""Between rows further apart in time nothing is known of the motion: robots turn within seconds."""


def with_radial_speed(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the table with `radial_speed_m_per_s`, where it can be had and is not there yet.

    Needs `time_s` and `true_range_m`. The speed of a row is the slope of the true range between
    its neighbours in time of the same pair (`tx`, `rx`) and environment; NaN without a neighbour
    within two seconds. Rows that stand in one place have 0. In a table that is read chunk by chunk
    the rows at a chunk's edges have one neighbour; give the column to have the same in all chunks.
    """
    if SPEED in frame or not {"time_s", "true_range_m"} <= set(frame.columns):
        return frame
    return frame.assign(**{SPEED: radial_speed_m_per_s(frame)})


def radial_speed_m_per_s(frame: pd.DataFrame) -> NDArray[np.float64]:
    """Return d(true range)/dt of every row [n] in metres per second, positive = moving apart."""
    speed = np.full(len(frame), np.nan)
    time = frame["time_s"].to_numpy(np.float64, na_value=np.nan)
    true = frame["true_range_m"].to_numpy(np.float64, na_value=np.nan)
    pair = _series_of(frame)
    order = np.lexsort((time, pair))
    order = order[np.isfinite(time[order]) & np.isfinite(true[order])]
    starts = np.flatnonzero(np.diff(pair[order], prepend=-1))
    for rows in np.split(order, starts[1:]):
        speed[rows] = _slopes(time[rows], true[rows])
    return speed


def _series_of(frame: pd.DataFrame) -> NDArray[np.intp]:
    """Return a number per pair of devices and environment, or per link where none are known."""
    names = [name for name in ("environment", "tx", "rx") if name in frame]
    if not {"tx", "rx"} <= set(names):
        names = [name for name in ("environment", "link") if name in frame]
    if not names:
        return np.zeros(len(frame), np.intp)
    return np.asarray(frame.groupby(names, dropna=False, sort=False).ngroup(), np.intp)


def _slopes(time: NDArray[np.float64], true: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slope at every time of one series: between both neighbours, or the nearer one."""
    step, rise = np.diff(time), np.diff(true)
    near = (step > 0) & (step <= LONGEST_GAP_S)
    rise, step = np.where(near, rise, 0.0), np.where(near, step, 0.0)
    before, after = np.r_[0.0, step], np.r_[step, 0.0]
    climbed = np.r_[0.0, rise] + np.r_[rise, 0.0]
    span = before + after
    return np.where(span > 0, climbed / np.where(span > 0, span, 1.0), np.nan)
