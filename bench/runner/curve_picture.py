"""A picture of learning curves: error left against links surveyed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.files import atomic_path, check_picture_name
from bench.results import Interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from bench.runner.curve import CurvePoint

COLOURS = ("#1b6ca8", "#d1603d", "#3d8b5f", "#7b5ea7", "#b8860b", "#4f5d75", "#c2457a", "#2a9d9d")


def save_curve(points: Sequence[CurvePoint], path: Path) -> None:
    """Draw the curves to a .png, .svg or .pdf file.

    Raises BenchError for another kind of file, and where the file cannot be written.
    """
    check_picture_name(path)
    figure = draw_curve(points)
    with atomic_path(path) as scratch:
        figure.savefig(scratch, dpi=150)


def draw_curve(points: Sequence[CurvePoint]) -> Figure:
    """Return the figure: a panel each for NLoS and LoS rows, as far as there are any."""
    from matplotlib.figure import Figure

    kinds = [kind for kind in ("nlos", "los") if any(getattr(p, f"{kind}_mae_m") for p in points)]
    figure = Figure(figsize=(5.6 * len(kinds) + 0.4, 4.4), layout="constrained")
    for ax, kind in zip(figure.subplots(1, len(kinds), squeeze=False)[0], kinds, strict=True):
        _draw_panel(ax, points, kind)
    first = points[0]
    figure.suptitle(f"{first.data}: error left by links trained on ({first.draws} draws)")
    return figure


def _draw_panel(ax: Axes, points: Sequence[CurvePoint], kind: str) -> None:
    names = sorted({(point.model, point.backend, point.seed) for point in points})
    for number, name in enumerate(names):
        own = [p for p in points if (p.model, p.backend, p.seed) == name]
        _draw_one(
            ax, sorted(own, key=lambda p: p.links), kind, " ".join(map(str, name[:2])), number
        )
    raw = {p.links: getattr(p, f"raw_{kind}_mae_m") for p in points}
    places = sorted(raw)
    ax.plot(places, [raw[k] for k in places], ":", color="#555555", label="before mitigation")
    ax.set_title({"nlos": "NLoS", "los": "LoS"}[kind], loc="left", fontsize=10)
    ax.set_xlabel("links trained on")
    ax.set_ylabel("mean |error left| (m), 95 % over draws")
    ax.set_ylim(0, None)
    ax.set_xticks(places)
    ax.spines[["top", "right"]].set_visible(False)
    ax.grid(color="#e6e6e6", linewidth=0.6)
    ax.legend(frameon=False, fontsize=8)


def _draw_one(ax: Axes, points: Sequence[CurvePoint], kind: str, label: str, number: int) -> None:
    """Draw one model's curve; neighbours are shifted a little so that bars do not overlap."""
    figures: list[Interval] = [getattr(point, f"{kind}_mae_m") for point in points]
    places = np.array([point.links for point in points], np.float64)
    places += 0.012 * number * max(np.ptp(places), 1.0)
    values = np.array([one.value for one in figures])
    low = np.array([one.value if one.low is None else one.low for one in figures])
    high = np.array([one.value if one.high is None else one.high for one in figures])
    colour = COLOURS[number % len(COLOURS)]
    # equal draws leave a bar of no length, which rounding may turn round
    bars = np.maximum([values - low, high - values], 0.0)
    ax.errorbar(
        places, values, bars, color=colour, marker="o", markersize=4,
        capsize=2, linewidth=1.5, label=label,
    )  # fmt: skip
