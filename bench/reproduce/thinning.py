"""Fewer rows for a quick run: whole links, alike in every environment and kind of sight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.table import Recordings

QUICK_ROWS = 6000
LEAST_LINKS = 6


def thinned(recordings: Recordings, rows: int = QUICK_ROWS, seed: int = 0) -> Recordings:
    """Return about `rows` rows: links drawn within every environment and label, none of them cut.

    Each such group keeps its share of rows, but at least six links (all, where it has fewer).
    Tables that are small enough are returned as they are.
    """
    if len(recordings) <= rows or "link" not in recordings.frame:
        return recordings
    frame = recordings.frame
    groups = [name for name in ("environment", "los") if name in frame]
    stratum = frame.groupby(groups, dropna=False).ngroup() if groups else pd.Series(0, frame.index)
    keep = _kept(frame["link"], stratum, rows / len(frame), np.random.default_rng(seed))
    return replace(recordings.select(keep), source=recordings.source)


def _kept(
    links: pd.Series, stratum: pd.Series, share: float, rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Return the rows of the links drawn."""
    keep = np.zeros(len(links), np.bool_)
    for number in np.unique(stratum):
        inside = (stratum == number).to_numpy()
        sizes = links[inside].value_counts(sort=False)
        order = rng.permutation(len(sizes))
        enough = np.cumsum(sizes.to_numpy()[order]) <= share * inside.sum()
        enough[:LEAST_LINKS] = True
        keep |= inside & links.isin(sizes.index[order[enough]]).to_numpy()
    return keep
