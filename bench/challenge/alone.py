"""What one of several hidden effects does to recorded ranges, where waveforms are recorded too."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.cases import Case, recorded_with

Floats = NDArray[np.float64]
SAME_M = 1e-3  # a host's rounding; a changed waveform moves an edge by more


def shift_of(case: Case, name: str) -> Floats | None:
    """Return what the hidden effect `name` adds to the range of every recorded row [n], in metres.

    None where it has no such shift: where it changes the waveform, or where it does something else
    when it comes alone (families draw the sizes of several effects from one stream).
    """
    if case.shifts_m is not None:
        return np.asarray(case.shifts_m[case.drawn.hidden.index(name)], np.float64)
    alone = _added_m(case.clean, recorded_with(case, (name,)))
    if alone is None or len(case.drawn.hidden) == 1:
        return alone
    others = recorded_with(case, tuple(one for one in case.drawn.hidden if one != name))
    beside = _added_m(others, case.recorded.frame)
    same = beside is not None and np.abs(beside - alone).max() < SAME_M
    return alone if same else None


def _added_m(before: pd.DataFrame, after: pd.DataFrame) -> Floats | None:
    """Return how much longer ranges are after [n], in metres; None where the waveforms differ."""
    if len(before) != len(after):
        return None
    if not all(map(np.array_equal, before["cir"], after["cir"])):
        return None
    return np.asarray(after["error_m"] - before["error_m"].to_numpy(), np.float64)
