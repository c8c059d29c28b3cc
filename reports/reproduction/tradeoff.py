"""Trade-off pictures: one quantity against another, looks shared by colour and by marker."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import cycle
from typing import Any

import numpy as np

from reports.figures import MARKERS
from reports.plain import tame
from reports.reproduction.load import FigureFile, Number, SeriesFile

COLOURS = (*(f"C{number}" for number in range(10)), "black", "gold", "navy", "lime")
LINES = {"line": "-", "dashed": "--", "step": "-"}
WIDE_DECADES = 1.5


def draw_tradeoff(axes: Any, one: FigureFile) -> list[Any]:
    """Draw points with both intervals, and lines; return the handles of the legend."""
    spots = [series for series in one.series if series.style not in LINES]
    colours = _looks((series.colour for series in spots), COLOURS)
    markers = _looks((series.marker for series in spots), MARKERS)
    for series in spots:
        _spot(axes, series, colours[series.colour], markers[series.marker])
    for series in one.series:
        if series.style in LINES:
            _line(axes, series)
    return [*_handles(colours, markers), *axes.get_legend_handles_labels()[0]]


def readable_ticks(axis: Any, low: float, high: float) -> None:
    """Label a logarithmic axis with plain numbers, as many as its width allows."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    wide = np.log10(high / low) > WIDE_DECADES if low > 0 else True
    axis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    axis.set_major_formatter(StrMethodFormatter("{x:,g}"))
    axis.set_minor_formatter(NullFormatter())


def _looks(names: Iterable[str], looks: Sequence[str]) -> dict[str, str]:
    """Return a look for every name, in order of appearance; they repeat when they run out."""
    return dict(zip(dict.fromkeys(names), cycle(looks), strict=False))


def _spot(axes: Any, series: SeriesFile, colour: str, marker: str) -> None:
    hollow = series.style == "hollow"
    x, y = _numbers(series.x), _numbers(series.y)
    axes.errorbar(
        x,
        y,
        xerr=_arms(x, series.x_low, series.x_high),
        yerr=_arms(y, series.low, series.high),
        color=colour,
        marker=marker,
        ms=8 if hollow else 6,
        markerfacecolor="none" if hollow else colour,
        elinewidth=0.7,
        alpha=0.9,
        ls="",
    )


def _line(axes: Any, series: SeriesFile) -> None:
    look: dict[str, Any] = {"color": "grey" if series.style == "dashed" else "black", "lw": 1}
    draw = axes.step if series.style == "step" else axes.plot
    where = {"where": "post"} if series.style == "step" else {}
    style = LINES[series.style]
    draw(
        _numbers(series.x),
        _numbers(series.y),
        ls=style,
        label=tame(series.name),
        **look,
        **where,
    )


def _handles(colours: dict[str, str], markers: dict[str, str]) -> list[Any]:
    from matplotlib.lines import Line2D

    lines = [
        Line2D([], [], color=colour, lw=4, label=tame(name)) for name, colour in colours.items()
    ]
    marks = [
        Line2D([], [], color="grey", marker=marker, ls="", label=tame(name))
        for name, marker in markers.items()
    ]
    return [*lines, *marks]


def _numbers(values: Sequence[float | str | None]) -> Any:
    return np.array([np.nan if value is None else value for value in values], np.float64)


def _arms(middle: Any, low: Sequence[Number] | None, high: Sequence[Number] | None) -> Any:
    """Return the lengths of the error bars, None where there are none."""
    if low is None or high is None:
        return None
    arms = np.stack([middle - _numbers(low), _numbers(high) - middle])
    return np.maximum(np.nan_to_num(arms), 0.0)
