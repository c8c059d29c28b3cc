"""A picture of a recordings table: CIRs, errors, and what errors depend on, LoS against NLoS."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.files import atomic_path, check_picture_name
from bench.recordings.describe import KINDS, row_kinds
from bench.recordings.picture_errors import COLOURS, SHOWN_PERCENTILES, error_panels
from bench.recordings.table import SAMPLE_PERIOD_NS, Recordings
from bench.recordings.window import cir_window
from bench.text import unmarked

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BEFORE, SHOWN_AFTER = 5, 60
BINS = 80


def save_picture(recordings: Recordings, path: Path) -> None:
    """Draw the table to a .png, .svg or .pdf file.

    Raises BenchError for another kind of file, and where the file cannot be written.
    """
    check_picture_name(path)
    figure = draw(recordings)
    with atomic_path(path) as scratch:
        figure.savefig(scratch, dpi=150)


def draw(recordings: Recordings) -> Figure:
    """Return the figure: CIRs aligned at the first path, and errors.

    Errors stand as a histogram, and by distance, level, time and link as far as these are known.
    """
    from matplotlib.figure import Figure

    panels = [lambda ax: _draw_errors(ax, recordings), *error_panels(recordings)]
    if "cir" in recordings.frame:
        panels.insert(0, lambda ax: _draw_cirs(ax, recordings))
    across = min(2, len(panels))
    down = -(-len(panels) // across)
    figure = Figure(figsize=(5.5 * across + 0.8, 3.7 * down + 0.5), layout="constrained")
    axes = figure.subplots(down, across, squeeze=False).ravel()
    for ax, panel in zip(axes, panels, strict=False):
        panel(ax)
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(color="#e6e6e6", linewidth=0.6)
        ax.set_axisbelow(True)
    for ax in axes[len(panels) :]:
        ax.set_axis_off()
    figure.suptitle(unmarked(_title(recordings)), fontsize=12, fontweight="bold")
    return figure


def _title(recordings: Recordings) -> str:
    """Return the source, marked SIMULATED where it is, with its size."""
    links = recordings.frame["link"].nunique() if "link" in recordings.frame else None
    size = f"{len(recordings):,} ranges".replace(",", " ")
    return f"{recordings.label}: {size}" + (f" over {links} links" if links else "")


def _draw_cirs(ax: Axes, recordings: Recordings) -> None:
    """Draw the median CIR of each kind with the band between its quartiles.

    Each CIR is divided by its own largest value: shapes are compared, not levels.
    """
    cirs, kinds, time_ns = _aligned(recordings)
    for kind in [kind for kind in KINDS if (kinds == kind).any()]:
        low, middle, high = np.percentile(cirs[kinds == kind], (25, 50, 75), axis=0)
        ax.fill_between(time_ns, low, high, color=COLOURS[kind], alpha=0.22, linewidth=0)
        label = f"{kind} ({int((kinds == kind).sum())})"
        ax.plot(time_ns, middle, color=COLOURS[kind], linewidth=1.8, label=label)
    ax.axvline(0.0, color="#555555", linewidth=0.9, linestyle=":")
    ax.set_xlabel("time after the detected first path (ns)")
    ax.set_ylabel("CIR magnitude / its maximum")
    ax.set_title("Median CIR, band between quartiles", fontsize=10, loc="left")
    ax.set_xlim(time_ns[0], time_ns[-1])
    ax.set_ylim(0, None)
    ax.legend(frameon=False)


def _aligned(
    recordings: Recordings,
) -> tuple[NDArray[np.float32], NDArray[np.str_], NDArray[np.float64]]:
    """Return scaled CIRs [n, k] with the first path at one place, their kinds, and times in ns.

    The first path lies between two samples: each CIR is shifted by that fraction (linearly).
    """
    frame = recordings.frame
    width = len(frame["cir"].iloc[0])
    first = frame.get("first_path_index", pd.Series([float(BEFORE)] * len(frame)))
    early, late = (int(np.nanpercentile(first, percent)) for percent in (10, 90))
    before, after = min(BEFORE, early, width - 1), min(SHOWN_AFTER, width - late)
    known = "first_path_index" in frame
    window = cir_window(recordings, before, max(1, after) if known else width - before)
    cirs = window.cirs / np.maximum(window.cirs.max(axis=1, keepdims=True), 1e-12)
    if known and cirs.shape[1] > 1:
        share = np.mod(first.to_numpy(np.float32)[window.rows, None], 1.0)
        cirs = (1 - share) * cirs[:, :-1] + share * cirs[:, 1:]
    period = float(np.nanmedian(frame.get("sample_period_ns", SAMPLE_PERIOD_NS)))
    time_ns = (np.arange(cirs.shape[1]) - before) * period
    return cirs, row_kinds(recordings)[window.rows], time_ns


def _draw_errors(ax: Axes, recordings: Recordings) -> None:
    """Draw the histogram of range errors of each kind, as densities."""
    errors, kinds = recordings.errors_m(), row_kinds(recordings)
    low, high = np.percentile(errors, SHOWN_PERCENTILES)
    edges = np.linspace(min(low, 0.0), max(high, 0.0) + 1e-9, BINS + 1)
    for kind in [kind for kind in KINDS if (kinds == kind).any()]:
        of_kind = errors[kinds == kind]
        label = f"{kind}: MAE {np.abs(of_kind).mean():.3f} m, $\\sigma$ {of_kind.std():.3f} m"
        density = np.histogram(of_kind, edges)[0] / (len(of_kind) * (edges[1] - edges[0]))
        ax.stairs(density, edges, color=COLOURS[kind], alpha=0.22, fill=True)
        ax.stairs(density, edges, color=COLOURS[kind], linewidth=1.5, label=label)
    outside = int(((errors < edges[0]) | (errors > edges[-1])).sum())
    ax.axvline(0.0, color="#555555", linewidth=0.9, linestyle=":")
    ax.set_xlabel("range error = measured - true (m)")
    ax.set_ylabel("density (1/m)")
    note = f" ({outside} rows lie outside)" if outside else ""
    ax.set_title(f"Range error{note}", fontsize=10, loc="left")
    ax.legend(frameon=False)
