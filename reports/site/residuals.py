"""What a run left of the errors, small enough for a page: histograms and profiles, in metres."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reports.ranking.predictions import MOST_BYTES, unchanged

if TYPE_CHECKING:
    import pandas as pd

BINS, STRETCHES, MOST_LINKS = 40, 8, 60
_COLUMNS = ("error_m", "predicted_m", "link", "true_range_m", "range_m", "rx_power_dbm")

Floats = NDArray[np.float64]


def residuals(path: Path) -> dict[str, Any] | None:
    """Return the views of one predictions file, None where it is absent or none.

    `histogram`: edges [m] and counts before and after; `distance` and `level`: edges and mean
    |error| before and after in up to eight stretches of equally many rows; `links`: the links with
    the largest mean |error| after, with both means; `calibration`: mean error in stretches of the
    predicted error.
    """
    frame = _read(path)
    if frame is None or frame.empty:
        return None
    before = frame["error_m"].to_numpy(np.float64)
    after = before - frame["predicted_m"].to_numpy(np.float64)
    views: dict[str, Any] = {"histogram": _histogram(before, after)}
    for name, column in (("distance", "true_range_m"), ("level", "rx_power_dbm")):
        if column in frame:
            views[name] = _profile(frame[column].to_numpy(np.float64), before, after)
    views["links"] = _links(frame["link"].astype(str), before, after)
    predicted = before - after
    edges, places = _stretches(predicted)
    views["calibration"] = {
        "predicted_m": _means(places, predicted, len(edges) - 1),
        "error_m": _means(places, before, len(edges) - 1),
    }
    return views


def _read(path: Path) -> pd.DataFrame | None:
    import pyarrow.parquet as parquet
    from pyarrow import ArrowException

    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES or not unchanged(path):
            return None
        there = parquet.read_schema(path).names
        frame = parquet.read_table(path, columns=[c for c in _COLUMNS if c in there]).to_pandas()
    except (OSError, ArrowException, ValueError):
        return None
    if not {"error_m", "predicted_m", "link"} <= set(frame.columns):
        return None
    finite = np.isfinite(frame["error_m"]) & np.isfinite(frame["predicted_m"])
    kept: pd.DataFrame = frame[finite]
    return kept


def _histogram(before: Floats, after: Floats) -> dict[str, Any]:
    """Return counts on common edges that hold all but the outermost percent."""
    low, high = np.quantile(np.concatenate([before, after]), [0.005, 0.995])
    edges = np.linspace(low, max(high, low + 1e-6), BINS + 1)
    return {
        "edges_m": _rounded(edges),
        "before": np.histogram(before, edges)[0].tolist(),
        "after": np.histogram(after, edges)[0].tolist(),
    }


def _profile(values: Floats, before: Floats, after: Floats) -> dict[str, Any]:
    known = np.isfinite(values)
    edges, places = _stretches(values[known])
    count = len(edges) - 1
    return {
        "edges": _rounded(edges),
        "before_m": _means(places, np.abs(before[known]), count),
        "after_m": _means(places, np.abs(after[known]), count),
    }


def _stretches(values: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Return edges of stretches with equally many rows, and every row's stretch."""
    if not len(values):
        return np.array([0.0]), np.empty(0, np.intp)
    edges = np.unique(np.quantile(values, np.linspace(0, 1, STRETCHES + 1)))
    if len(edges) < 2:
        edges = np.array([edges[0], edges[0] + 1e-9])
    places = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    return edges, places


def _means(places: NDArray[np.intp], values: Floats, count: int) -> list[float | None]:
    total = np.bincount(places, values, count)
    rows = np.bincount(places, minlength=count)
    return [round(float(t / n), 5) if n else None for t, n in zip(total, rows, strict=True)]


def _links(names: pd.Series[str], before: Floats, after: Floats) -> list[dict[str, Any]]:
    table = names.to_frame("link").assign(before=np.abs(before), after=np.abs(after))
    means = table.groupby("link")[["before", "after"]].mean()
    worst = means.sort_values("after", ascending=False).head(MOST_LINKS)
    return [
        {"link": str(name), "before_m": round(float(b), 4), "after_m": round(float(a), 4)}
        for name, b, a in zip(worst.index, worst["before"], worst["after"], strict=True)
    ]


def _rounded(values: Floats) -> list[float]:
    return [round(float(value), 4) for value in values]
