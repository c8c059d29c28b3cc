"""Differences in per cent of one model's MAE, data set by data set, with their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from reports.errors import ReportError
from reports.figures import MARKERS
from reports.ranking.paired import Interval
from reports.together import Line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_INCHES, ROW_INCHES = 7.5, 0.5
SPREAD = 0.6  # of a row is shared by its models


def draw(lines: Sequence[Line], baseline: str) -> Figure:
    """Return a row per data set and kind, a point with its interval per model.

    Raises ReportError where there are no two data sets to compare on.
    """
    from matplotlib.figure import Figure

    if not lines:
        raise ReportError(f"expected at least two data sets with {baseline} to draw")
    labels = list(lines[0].found)
    figure = Figure(figsize=(WIDTH_INCHES, 1.2 + ROW_INCHES * len(labels)), layout="constrained")
    axes = figure.subplots()
    for number, line in enumerate(lines):
        _points(axes, line, number, (number + 0.5) / len(lines) - 0.5)
    axes.axvline(0, color="black", linewidth=0.8)
    axes.set_yticks(range(len(labels)), labels)
    axes.invert_yaxis()
    axes.set_xlabel(f"MAE minus {baseline}'s, % of the latter (95 % interval over links)")
    axes.grid(axis="x", alpha=0.3)
    axes.legend(loc="best", fontsize="small")
    return figure


def _points(axes: Axes, line: Line, number: int, shift: float) -> None:
    """Draw a model's figures, the known ones."""
    known = {row: one for row, one in enumerate(line.found.values()) if one is not None}
    values = [100 * one.value for one in known.values()]
    axes.errorbar(
        values,
        [row + SPREAD * shift for row in known],
        xerr=_reaches(list(known.values())),
        fmt=MARKERS[number % len(MARKERS)],
        color=f"C{number % 10}",
        markersize=5,
        capsize=2,
        label=line.model,
    )


def _reaches(known: Sequence[Interval]) -> list[list[float]]:
    """Return how far intervals reach below and above their values, in per cent."""
    ends = [(one.value if one.low is None else one.low) for one in known]
    tops = [(one.value if one.high is None else one.high) for one in known]
    below = [100 * (one.value - low) for one, low in zip(known, ends, strict=True)]
    above = [100 * (high - one.value) for one, high in zip(known, tops, strict=True)]
    return [[max(0.0, one) for one in below], [max(0.0, one) for one in above]]
