"""A link is one pair of antenna positions: a drive under one name is cut into places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.motion import with_radial_speed

PLACE_M: Final = 1.0
"""Side of a place in metres: some tens of wavelengths, within which reflections change."""
PLENTY: Final = 24
"""Links from which on they are left alone: whole links say more than places of one drive."""
POSITIONS: Final = tuple(f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz")


def cut_into_places(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the table with `link` cut by place where few links hold antennas that move.

    A link that moves by more than two places of 1 m (its positions, or its true range where
    positions are not known) becomes one link per place; the radial speed is taken before. A table
    of 24 links or more, or without `link`, stays as it is.
    """
    if "link" not in frame or not 0 < frame["link"].nunique() < PLENTY:
        return frame
    columns = [name for name in POSITIONS if name in frame] or ["true_range_m"]
    if not set(columns) <= set(frame.columns):
        return frame
    moving = _moving(frame, columns)
    if not moving.any():
        return frame
    names = frame["link"].astype(object).where(~moving, _named(frame, columns))
    return with_radial_speed(frame).assign(link=names)


def distance_m(frame: pd.DataFrame) -> NDArray[np.float64]:
    """Return how far antennas are from each other [n] in metres, NaN unless all six are known."""
    if not set(POSITIONS) <= set(frame.columns):
        return np.full(len(frame), np.nan)
    ends = frame[list(POSITIONS)].apply(pd.to_numeric, errors="coerce").to_numpy(np.float64)
    return np.asarray(np.linalg.norm(ends[:, :3] - ends[:, 3:], axis=1))


def link_count(frame: pd.DataFrame) -> int:
    """Return how many links a table names."""
    return int(frame["link"].nunique()) if "link" in frame else 0


def _moving(frame: pd.DataFrame, columns: Sequence[str]) -> NDArray[np.bool_]:
    """Return which rows [n] are of a link that spreads over more than two places."""
    groups = frame.groupby("link", dropna=True)[list(columns)]
    spread = (groups.transform("max") - groups.transform("min")).max(axis=1)
    return (spread > 2 * PLACE_M).to_numpy(np.bool_)


def _named(frame: pd.DataFrame, columns: Sequence[str]) -> pd.Series:
    """Return the link and the lower corner of every row's place, of what moves, as one name.

    What is not known is place 0.
    """
    within = frame.groupby("link", dropna=True)[list(columns)].agg(np.ptp).max()
    known = frame[[name for name in columns if within[name] > 0]].astype("float64").fillna(0.0)
    cells = np.floor(known.to_numpy() / PLACE_M) * PLACE_M
    where = [" ".join(f"{side:g}" for side in cell) for cell in cells.tolist()]
    return frame["link"].astype(str) + " at " + pd.Series(where, frame.index) + " m"
