"""Levels that agree as far as a reading of levels tells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import REPORTED_LEVELS
from bench.discrepancy.locate.hypotheses import Cell
from bench.discrepancy.settings import READ_ALIKE, READ_FARTHEST, RESOLUTION


def unreadable(ensemble: Ensemble, cells: Sequence[Cell]) -> NDArray[np.bool_]:
    """Return which cells [K] are of a level that both sides have alike as readings go.

    A simulator without waveforms gives levels that do not scatter at all, so that a hundredth of a
    decibel in the recorded ones is seen without doubt; no receiver reads it.
    """
    alike = {name for name in REPORTED_LEVELS if name in ensemble.names and _alike(ensemble, name)}
    return np.array([cell.observable in alike for cell in cells], np.bool_)


def as_read(shifts: Mapping[str, float]) -> dict[str, float]:
    """Return the smallest shifts that would be seen, those of levels no smaller than are read."""
    return {
        name: max(shift, RESOLUTION["dB"]) if name in REPORTED_LEVELS else shift
        for name, shift in shifts.items()
    }


def _alike(ensemble: Ensemble, name: str) -> bool:
    """Return whether nearly all rows have the simulated level but for what readings scatter by."""
    off_db = np.abs(ensemble.residual_of(name))
    known = off_db[np.isfinite(off_db)]
    if not len(known):
        return False
    most = float(np.quantile(known, READ_ALIKE))
    scatter = float(np.sqrt(np.mean(np.minimum(known, most) ** 2)))
    return most < READ_FARTHEST * RESOLUTION["dB"] and scatter < RESOLUTION["dB"]
