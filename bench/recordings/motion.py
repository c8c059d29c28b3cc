"""How fast two antennas move apart, from true ranges and times."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.slopes import LONGEST_GAP_S, slopes

SPEED = "radial_speed_m_per_s"
NEAREST_ROWS = (8, 4, 2, 1)
"""Rows of a device before and after one, of which its velocity is taken: so many partners answer in
one round. Fewer where a device turns."""
FEWEST_PLACES = 3
"""Rows, of which a line says whether they lie on it."""
OFF_LINE_M = 0.1
"""Root mean square; where places of a device are farther from an even motion it turns, or its times
belong to several of one name."""
_AXES = "xyz"


def with_radial_speed(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the table with `radial_speed_m_per_s`, where it can be had and is not there yet.

    Needs `time_s` and `true_range_m`. The speed of a row is the slope of the true range among
    its neighbours in time, of the same pair (`tx`, `rx`) and environment: two on either side where
    they are as far apart as each other, more where the truth is noisy (see `slopes`); NaN without
    a neighbour within two seconds. Rows that stand in one place have 0. In a table that is read
    chunk by chunk the rows at a chunk's edges have fewer neighbours; give the column to have the
    same in all chunks.
    """
    if SPEED in frame or not {"time_s", "true_range_m"} <= set(frame.columns):
        return frame
    return frame.assign(**{SPEED: radial_speed_m_per_s(frame)})


def why_unknown(frame: pd.DataFrame) -> str:
    """Return in words what a table needs that tells no radial speed."""
    if not {"time_s", "true_range_m"} <= set(frame.columns):
        return f"{SPEED}, or time_s and true_range_m"
    return f"{SPEED}, or rows of a pair of devices within two seconds of each other"


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
        speed[rows] = slopes(time[rows], true[rows])
    return speed


def _series_of(frame: pd.DataFrame) -> NDArray[np.intp]:
    """Return a number per pair of devices and environment, or per link where none are known."""
    names = [name for name in ("environment", "tx", "rx") if name in frame]
    if not {"tx", "rx"} <= set(names):
        names = [name for name in ("environment", "link") if name in frame]
    if not names:
        return np.zeros(len(frame), np.intp)
    return np.asarray(frame.groupby(names, dropna=False, sort=False).ngroup(), np.intp)


def speed_by_places_m_per_s(frame: pd.DataFrame) -> NDArray[np.float64]:
    """Return the radial speed of every row [n] in metres per second by where its devices are.

    A device that is asked once by each of several partners moves between their rows, though no pair
    has two. NaN where times, positions or devices are not known, or places contradict each other.
    """
    places = {end: [f"{end}_{axis}_m" for axis in _AXES] for end in ("tx", "rx")}
    if not {"time_s", *places, *places["tx"], *places["rx"]} <= set(frame.columns):
        return np.full(len(frame), np.nan)
    time = frame["time_s"].to_numpy(np.float64, na_value=np.nan)
    at = {end: frame[names].to_numpy(np.float64, na_value=np.nan) for end, names in places.items()}
    rooms = ["environment"] if "environment" in frame else []
    named = (frame.groupby([*rooms, end], dropna=False).ngroup() for end in places)
    tx, rx = (
        _velocity(np.asarray(one, np.intp), time, at[end])
        for one, end in zip(named, places, strict=True)
    )
    moved, line = tx - rx, at["tx"] - at["rx"]
    far = np.maximum(np.linalg.norm(line, axis=1), 1e-9)
    return np.asarray((moved * line).sum(axis=1) / far)


def _velocity(
    device: NDArray[np.intp], time: NDArray[np.float64], at: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the velocity [n, 3] of devices at [n, 3]: 0 where they never move, NaN where unknown.

    The slope of a straight line through the nearest rows, as many of these as are on one.
    """
    order = np.lexsort((time, device))
    sorted_ = device[order], time[order], at[order]
    made = _along_line(*sorted_, NEAREST_ROWS[0], 1)
    for reach in NEAREST_ROWS[1:]:
        made = np.where(np.isfinite(made), made, _along_line(*sorted_, reach, FEWEST_PLACES))
    out = np.empty_like(at)
    out[order] = made
    out[_still(device, at)] = 0.0
    return out


def _along_line(
    device: NDArray[np.intp],
    time: NDArray[np.float64],
    at: NDArray[np.float64],
    reach: int,
    fewest: int,
) -> NDArray[np.float64]:
    """Return the velocity [n, 3] of a line through up to `reach` rows on either side of each.

    Rows are in the order of devices and times. NaN where fewer than `fewest` are known, or where
    these are off the line.
    """
    dt, by, known = _near(device, time, at, reach)
    count = np.maximum(known.sum(axis=0), 1)[:, None]
    dt = np.where(known, dt - (dt * known).sum(axis=0) / count[:, 0], 0.0)
    by = np.where(known[..., None], by - (by * known[..., None]).sum(axis=0) / count, 0.0)
    span = (dt**2).sum(axis=0)
    slope = (dt[..., None] * by).sum(axis=0) / np.where(span > 0, span, np.nan)[:, None]
    off = ((by - dt[..., None] * slope) ** 2).sum(axis=(0, 2)) / count[:, 0]
    held = (off < OFF_LINE_M**2) & (count[:, 0] >= fewest)
    return np.where(held[:, None], slope, np.nan)


def _near(
    device: NDArray[np.intp], time: NDArray[np.float64], at: NDArray[np.float64], reach: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return times [k, n] and places [k, n, 3] of the nearest rows beside each, and which count."""
    rows = np.arange(len(time))
    away = rows + np.arange(-reach, reach + 1)[:, None]
    near = np.clip(away, 0, len(time) - 1)
    dt, by = time[near] - time, at[near] - at
    known = (near == away) & (device[near] == device) & (np.abs(dt) <= LONGEST_GAP_S)
    known &= np.isfinite(by).all(axis=-1)
    return np.where(known, dt, 0.0), np.where(known[..., None], by, 0.0), known


def _still(device: NDArray[np.intp], at: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which rows [n] are of a device that is in one place in all of them."""
    groups = pd.DataFrame(at).groupby(device)
    moves = groups.transform("max") - groups.transform("min")
    return np.asarray((moves == 0).all(axis=1))
