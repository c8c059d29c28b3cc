"""Columns of a recordings table as numbers, and without those that must not be seen."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.settings import FASTEST_M_PER_S, HIGH_QUANTILE, MOVING_SHARE, SLOWEST_M_PER_S
from bench.recordings.motion import SPEED, radial_speed_m_per_s, speed_by_places_m_per_s

Floats = NDArray[np.float64]
WAVES = ("cir", "first_path_index")  # what waveforms are compared by
UNIT_AT_END = re.compile(r"_(s|ms|us|ns|m|mm|m_per_s|deg|rad|c|k|db|dbm|ppm|hz|mhz|ghz)$")


def numeric(frame: pd.DataFrame, name: str) -> Floats:
    """Return a numeric column [n], NaN where unknown or absent."""
    if name not in frame:
        return np.full(len(frame), np.nan)
    return np.asarray(pd.to_numeric(frame[name], errors="coerce"), np.float64)


def hidden(frame: pd.DataFrame, columns: tuple[str, ...]) -> pd.DataFrame:
    """Return the table without some columns, so that the diagnosis cannot see them."""
    return frame.drop(columns=[c for c in columns if c in frame])


def known_columns(frame: pd.DataFrame) -> set[str]:
    """Return the columns that hold a value anywhere, not only NaN or nothing."""
    return {str(name) for name in frame if frame[name].notna().any()}


def has_waveforms(frame: pd.DataFrame) -> bool:
    """Return whether a table has CIRs with the position of their first path."""
    return set(WAVES) <= known_columns(frame)


def with_motion(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the table with the radial speed of its rows, NaN everywhere where none can be had.

    From positions in time within each link: rows of two links of one pair of devices are no
    movement. Speeds that no vehicle has are times that do not belong together. Where rows of links
    move, one that is alone in its link has the speed of its devices among all their links.
    """
    if SPEED in frame or not {"time_s", "true_range_m", "link"} <= set(frame.columns):
        return frame
    place = frame["link"].astype(str)
    if "environment" in frame:
        place = place + "|" + frame["environment"].astype(str)
    speed = radial_speed_m_per_s(frame.assign(environment=place))
    known = np.abs(speed[np.isfinite(speed)])
    moves = len(known) > MOVING_SHARE * len(speed)
    typical = float(np.quantile(known, HIGH_QUANTILE)) if moves else 0.0
    plausible = SLOWEST_M_PER_S < typical < FASTEST_M_PER_S
    if not plausible:
        return frame.assign(**{SPEED: np.nan})
    alone = ~np.isfinite(speed)
    return frame.assign(**{SPEED: np.where(alone, speed_by_places_m_per_s(frame), speed)})
