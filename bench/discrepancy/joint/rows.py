"""The rows whose waveforms are compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import View
from bench.discrepancy.joint.settings import ROWS
from bench.discrepancy.select.state import Search


def compared_rows(search: Search) -> View:
    """Return the working rows that sets are judged and sized by, at most `ROWS`."""
    return fewer(search.both, ROWS)


def fewer(rows: View, most: int) -> View:
    """Return at most so many rows, evenly from all links."""
    if len(rows.rows) <= most:
        return rows
    order = np.argsort(rows.links, kind="stable")
    keep = np.sort(order[np.linspace(0, len(order) - 1, most).astype(np.intp)])
    return taken(rows, keep)


def taken(rows: View, keep: NDArray[np.intp]) -> View:
    """Return some rows of a view, by their places [k]."""
    recorded = replace(rows.recorded, values=rows.recorded.values[keep])
    frame = rows.frame.iloc[keep].reset_index(drop=True)
    return View(frame, recorded, rows.links[keep], rows.rows[keep], rows.waveform)
