"""Columns of a recordings table as numbers, and without those that must not be seen."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]


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
    return {"cir", "first_path_index"} <= known_columns(frame)
