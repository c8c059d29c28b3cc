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
