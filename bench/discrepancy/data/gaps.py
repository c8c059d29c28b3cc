"""Temperatures that are not known in some rows, from the rows before and after them in time.

A device and a room warm up slowly. A row without its temperature would else be taken for one at 25
degrees, and a column with many such rows for none.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.settings import GAP_ERROR, GAP_KNOWN
from bench.physics.units import Floats

TEMPERATURE, TIME = "temperature_c", "time_s"


def with_temperatures(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table with its temperatures [n] filled in where time tells them, else as it is."""
    filled = _filled(frame)
    return frame if filled is None else frame.assign(**{TEMPERATURE: filled})


def gap_words(frame: pd.DataFrame) -> tuple[str, ...]:
    """Return in words how many temperatures are not known, and where they are taken from."""
    if TEMPERATURE not in frame:
        return ()
    unknown = int((~np.isfinite(numeric(frame, TEMPERATURE))).sum())
    if not 0 < unknown < len(frame):
        return ()
    taken = (
        "these are at 25 degrees" if _filled(frame) is None
        else "taken from the rows before and after in time"
    )  # fmt: skip
    return (f"{TEMPERATURE} is not known in {unknown} of {len(frame)} recorded rows: {taken}",)


def _filled(frame: pd.DataFrame) -> Floats | None:
    """Return temperatures [n] with no gaps; None where there are none, or time does not tell."""
    warm, time_s = numeric(frame, TEMPERATURE), numeric(frame, TIME)
    known = np.isfinite(warm) & np.isfinite(time_s)
    gaps = ~np.isfinite(warm) & np.isfinite(time_s)
    if not gaps.any() or known.mean() < GAP_KNOWN:
        return None
    order = np.flatnonzero(known)[np.argsort(time_s[known], kind="stable")]
    at, value = time_s[order], warm[order]
    every = np.arange(1, len(order) - 1)
    between = (value[every - 1] + value[every + 1]) / 2
    if not len(every) or np.std(value[every] - between) > GAP_ERROR * np.std(value):
        return None
    return np.where(gaps, np.interp(time_s, at, value), warm)
