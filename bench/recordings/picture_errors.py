"""Range errors against what they may depend on: distance, level, link and time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.recordings.describe import KINDS, row_kinds
from bench.recordings.table import Recordings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {"LoS": "#1b6ca8", "NLoS": "#d1603d", "unlabelled": "#4f5d75"}
MAX_POINTS = 3000  # more only make a blot; which are drawn is the seed's choice
MAX_BINS, MIN_ROWS_PER_BIN = 20, 5
SHOWN_PERCENTILES = (0.5, 99.5)
Floats = NDArray[np.float64]
Panel = Callable[["Axes"], None]
_LEVELS = {
    "rx_power_dbm": "receive level (dBm)",
    "first_path_power_dbm": "first-path level (dBm)",
}


def error_panels(recordings: Recordings) -> Iterator[Panel]:
    """Yield what draws each panel the table has the columns for."""
    for column, label in _axes(recordings):
        yield lambda ax, column=column, label=label: _draw_against(ax, recordings, column, label)  # type: ignore[misc]
    if "link" in recordings.frame:
        yield lambda ax: _draw_links(ax, recordings)


def _axes(recordings: Recordings) -> Iterator[tuple[str, str]]:
    """Yield the columns to draw against with their labels; the first level that is known."""
    wanted = {"true_range_m": "true distance (m)", "time_s": "time in the session (s)"}
    level = next((name for name in _LEVELS if _varies(recordings, name)), None)
    if level:
        wanted[level] = _LEVELS[level]
    order = ("true_range_m", level, "time_s")
    for column in order:
        if column and _varies(recordings, column):
            yield column, wanted[column]


def _varies(recordings: Recordings, column: str) -> bool:
    """Return whether a column is there with more than one value."""
    return column in recordings.frame and recordings.frame[column].nunique() > 1


def _draw_against(ax: Axes, recordings: Recordings, column: str, label: str) -> None:
    """Draw errors against a column: rows as points, medians and quartiles of bins."""
    values = recordings.frame[column].to_numpy(np.float64, na_value=np.nan)
    errors, kinds = recordings.errors_m(), row_kinds(recordings)
    for kind in [kind for kind in KINDS if (kinds == kind).any()]:
        rows = np.flatnonzero((kinds == kind) & np.isfinite(values))
        shown = _thinned(rows)
        ax.plot(values[shown], errors[shown], ".", color=COLOURS[kind], alpha=0.15, markersize=3)
        if len(rows):
            _draw_bins(ax, values[rows], errors[rows], kind)
    _finish(ax, errors)
    ax.set_xlabel(label)
    ax.set_title(f"Error by {label.partition(' (')[0]}", fontsize=10, loc="left")
    ax.legend(frameon=False, fontsize=8)


def _thinned(rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return at most 3 000 of the rows, chosen by a fixed seed."""
    if len(rows) <= MAX_POINTS:
        return rows
    return np.sort(np.random.default_rng(0).choice(rows, MAX_POINTS, replace=False))


def _draw_bins(ax: Axes, values: Floats, errors: Floats, kind: str) -> None:
    """Draw the median and the band between quartiles of bins; bins with few rows leave gaps."""
    edges = np.linspace(values.min(), values.max(), MAX_BINS + 1)
    place = np.clip(np.digitize(values, edges) - 1, 0, MAX_BINS - 1)
    quartiles = np.full((MAX_BINS, 3), np.nan)
    for number in range(MAX_BINS):
        if (place == number).sum() >= MIN_ROWS_PER_BIN:
            quartiles[number] = np.percentile(errors[place == number], (25, 50, 75))
    centres, colour = (edges[:-1] + edges[1:]) / 2, COLOURS[kind]
    ax.fill_between(centres, quartiles[:, 0], quartiles[:, 2], color=colour, alpha=0.2, linewidth=0)
    ax.vlines(centres, quartiles[:, 0], quartiles[:, 2], color=colour, alpha=0.5, linewidth=1.2)
    label = f"{kind}: median, quartiles"
    ax.plot(centres, quartiles[:, 1], "o-", color=colour, markersize=3, linewidth=1.6, label=label)


def _draw_links(ax: Axes, recordings: Recordings) -> None:
    """Draw each link's median error and quartiles, links in the order of their median."""
    errors, kinds = recordings.errors_m(), row_kinds(recordings)
    links = recordings.frame["link"].astype("str").to_numpy(np.str_)
    places = _ranks(links, errors)
    for kind in [kind for kind in KINDS if (kinds == kind).any()]:
        rows = kinds == kind
        found = [
            (places[link], *np.percentile(errors[rows & (links == link)], (25, 50, 75)))
            for link in np.unique(links[rows])
        ]
        place, low, middle, high = np.array(found).T
        width = float(np.clip(150 / max(1, len(places)), 0.6, 3.0))
        ax.vlines(place, low, high, color=COLOURS[kind], alpha=0.45, linewidth=width)
        ax.plot(place, middle, ".", color=COLOURS[kind], markersize=3 + width, label=kind)
    _finish(ax, errors)
    ax.set_xlabel(f"{len(places)} links, in the order of their median")
    ax.set_title("Error by link: median and quartiles", fontsize=10, loc="left")
    ax.legend(frameon=False, fontsize=8)


def _ranks(links: NDArray[np.str_], errors: Floats) -> dict[str, int]:
    """Return each link's place in the order of medians."""
    names = np.unique(links)
    medians = [float(np.median(errors[links == name])) for name in names]
    return {str(names[index]): place for place, index in enumerate(np.argsort(medians))}


def _finish(ax: Axes, errors: Floats) -> None:
    """Set the error axis to where the rows are, zero included."""
    low, high = np.percentile(errors, SHOWN_PERCENTILES)
    margin = 0.06 * (max(high, 0.0) - min(low, 0.0)) + 1e-9
    ax.set_ylim(min(low, 0.0) - margin, max(high, 0.0) + margin)
    ax.axhline(0.0, color="#555555", linewidth=0.9, linestyle=":")
    ax.set_ylabel("range error (m)")
