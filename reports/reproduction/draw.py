"""Pictures of outcomes, as SVG and PNG. matplotlib without pyplot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.figures import MARKERS, save_png, save_svg
from reports.plain import tame
from reports.reproduction.load import FigureFile, OutcomeFile, SeriesFile
from reports.reproduction.pages import picture_path, shown
from reports.reproduction.tradeoff import draw_tradeoff, readable_ticks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INCHES = (7.6, 4.6)
TRADEOFF_INCHES = (9.0, 5.6)
Save = Callable[[Path], None]


def pictures(outcome: OutcomeFile) -> Iterator[tuple[str, Save]]:
    """Yield (path relative to the page, what writes it) of every picture, SVG and PNG."""
    for one in outcome.figures:
        drawn = draw(one, shown(outcome, one))
        yield picture_path(outcome, one.name, ".svg"), partial(save_svg, drawn)
        yield picture_path(outcome, one.name, ".png"), partial(save_png, drawn)


def draw(one: FigureFile, data: str) -> Figure:
    """Return a picture; `data` says what it shows."""
    from matplotlib.figure import Figure

    kinds: dict[str, Callable[[Any, FigureFile], list[Any] | None]] = {
        "lines": _points, "scatter": _points, "histogram": _histogram, "bars": _bars,
        "scatter3d": _cloud, "tradeoff": draw_tradeoff,
    }  # fmt: skip
    size = TRADEOFF_INCHES if one.kind == "tradeoff" else INCHES
    figure = Figure(figsize=size, layout="constrained")
    axes: Any = figure.add_subplot(projection="3d" if one.kind == "scatter3d" else None)
    handles = kinds[one.kind](axes, one)
    _dress(axes, one, data, handles)
    return figure


def _dress(axes: Any, one: FigureFile, data: str, handles: list[Any] | None) -> None:
    axes.set_title(f"{tame(one.title)}\n{tame(data)}", fontsize=10)
    axes.set_xlabel(tame(one.x_label))
    axes.set_ylabel(tame(one.y_label))
    if one.kind == "scatter3d":
        axes.set_zlabel(tame(one.z_label))
        _make_room(axes)
    else:
        axes.grid(alpha=0.3)
    for axis, logarithmic in (("x", one.log_x), ("y", one.log_y)):
        if logarithmic:
            _make_logarithmic(axes, axis)
    if one.equal_axes:
        axes.set_aspect("equal", adjustable="datalim")
    place = (1.12, 0.5) if one.kind == "scatter3d" else (1.01, 0.5)
    scale = 3 if one.kind == "scatter3d" else 1
    axes.legend(
        handles=handles, fontsize=8, loc="center left", bbox_to_anchor=place, markerscale=scale
    )


def _make_room(axes: Any) -> None:
    """Keep the labels of a 3-D picture inside it and off its ticks."""
    from matplotlib.ticker import MaxNLocator

    axes.set_box_aspect(None, zoom=0.8)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(5))
        axis.labelpad = 6


def _make_logarithmic(axes: Any, axis: str) -> None:
    getattr(axes, f"set_{axis}scale")("log")
    readable_ticks(getattr(axes, f"{axis}axis"), *getattr(axes, f"get_{axis}lim")())


def _numbers(values: Any) -> Any:
    return np.array([np.nan if value is None else value for value in values], np.float64)


def _points(axes: Any, one: FigureFile) -> None:
    """Draw lines or points, with error bars where the series has an interval."""
    joined = "-" if one.kind == "lines" else ""
    for series, marker in zip(one.series, cycle(MARKERS), strict=False):
        y = _numbers(series.y)
        if series.style in ("line", "dashed"):
            dash = "--" if series.style == "dashed" else "-"
            axes.plot(_numbers(series.x), y, dash, color="black", lw=1, label=tame(series.name))
            continue
        big = series.style == "marker"
        look: dict[str, Any] = {
            "ms": 10 if big else 4,
            "ls": "" if big else joined,
            "zorder": 3 if big else 2,
        }
        look["alpha"] = 1.0 if big or joined else 0.6
        arms = _arms(series, y)
        axes.errorbar(
            _numbers(series.x),
            y,
            yerr=arms,
            marker=marker,
            capsize=3,
            label=tame(series.name),
            **look,
        )


def _arms(series: SeriesFile, y: Any) -> Any:
    if series.low is None or series.high is None:
        return None
    below, above = y - _numbers(series.low), _numbers(series.high) - y
    return np.maximum(np.nan_to_num(np.stack([below, above])), 0.0)


def _histogram(axes: Any, one: FigureFile) -> None:
    for series in one.series:
        x, y = _numbers(series.x), _numbers(series.y)
        if series.style:
            axes.plot(x, y, "--", color="black", lw=1, label=tame(series.name))
        else:
            axes.fill_between(x, y, step="mid", alpha=0.5, label=tame(series.name))


def _bars(axes: Any, one: FigureFile) -> None:
    """Draw groups of bars: one group per x, one bar per series; dashed ones as a line over each."""
    names = list(dict.fromkeys(str(x) for series in one.series for x in series.x))
    solid = [series for series in one.series if not series.style]
    width = 0.8 / max(1, len(solid))
    for number, series in enumerate(solid):
        y = _numbers(series.y)
        x = np.array([names.index(str(value)) for value in series.x], np.float64)
        x += (number - (len(solid) - 1) / 2) * width
        axes.bar(x, y, width, yerr=_arms(series, y), capsize=2, label=tame(series.name))
    for series in (line for line in one.series if line.style):
        at = np.array([names.index(str(value)) for value in series.x], np.float64)
        axes.hlines(
            _numbers(series.y), at - 0.45, at + 0.45, "black", ls="--", label=tame(series.name)
        )
    axes.set_xticks(range(len(names)), names, rotation=20, ha="right")


def _cloud(axes: Any, one: FigureFile) -> None:
    for series in one.series:
        z = _numbers(series.z or ())
        axes.scatter(
            _numbers(series.x), _numbers(series.y), z, s=4, alpha=0.5, label=tame(series.name)
        )
