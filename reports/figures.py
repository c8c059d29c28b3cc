"""Latency against error with the Pareto front, as SVG and PNG. matplotlib without pyplot."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from reports.boards import Board, Entry
from reports.errors import ReportError
from reports.leaderboard import title
from reports.pareto import pareto_front
from reports.plain import tame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKERS = "osD^vP*Xh<>p"
PANEL_INCHES = (7.0, 4.6)
PNG_DPI = 150


FAR = 2.0  # times the error without mitigation
COLOURS = (
    *(f"C{number}" for number in range(10)),
    "navy", "gold", "darkgreen", "black", "lightsalmon", "indigo", "turquoise", "silver",
)  # fmt: skip


@dataclass(frozen=True)
class Point:
    """One model on one backend: latency in microseconds and NLoS MAE in metres, with intervals.

    An `unstable` latency cannot be quoted: such a point is hollow and not on the front.
    """

    model: str
    backend: str
    latency_us: float
    latency_low_us: float
    latency_high_us: float
    mae_m: float
    mae_low_m: float
    mae_high_m: float
    unstable: bool


def points(board: Board, device: str | None = None) -> list[Point]:
    """Return what can be drawn of a board: measured latency, or a device's estimate.

    The floor is no point: no mitigation takes no time.
    """
    found = (_point(entry, device) for entry in board.entries if not entry.is_floor)
    return [point for point in found if point is not None]


def latency_against_error(boards: Sequence[Board], device: str | None = None) -> Figure:
    """Return one panel per board. Raises ReportError where no board has a point."""
    from matplotlib.figure import Figure

    drawn = [(board, some) for board in boards if (some := points(board, device))]
    if not drawn:
        where = f"an estimate for device {device!r}" if device else "a measured latency"
        raise ReportError(f"nothing to plot: no result has both an NLoS MAE and {where}")
    figure = Figure(figsize=(PANEL_INCHES[0], PANEL_INCHES[1] * len(drawn)), layout="constrained")
    panels = figure.subplots(len(drawn), 1, squeeze=False)[:, 0]
    for axes, (board, some) in zip(panels, drawn, strict=True):
        _panel(axes, board, some, device)
    return figure


def save_svg(figure: Figure, path: Path) -> None:
    """Write the figure as SVG; the same figure gives the same bytes."""
    with _repeatable():
        figure.savefig(path, format="svg", metadata={"Date": None})


def save_png(figure: Figure, path: Path) -> None:
    """Write the figure as PNG."""
    figure.savefig(path, format="png", dpi=PNG_DPI, metadata={"Software": None})


@contextmanager
def _repeatable() -> Iterator[None]:
    """Element ids of an SVG are random unless salted."""
    from matplotlib import rc_context

    with rc_context({"svg.hashsalt": "uwb-bench"}):
        yield


def _point(entry: Entry, device: str | None) -> Point | None:
    latency = _latency(entry, device)
    if entry.nlos is None or latency is None or not math.isfinite(entry.nlos.mae_m.value):
        return None
    mae = entry.nlos.mae_m
    low = mae.value if mae.low is None else mae.low
    high = mae.value if mae.high is None else mae.high
    measured = entry.latency(1) if device is None else None
    unstable = measured is not None and measured.unstable
    return Point(entry.model, entry.backend, *latency, mae.value, low, high, unstable)


def _latency(entry: Entry, device: str | None) -> tuple[float, float, float] | None:
    """Return value, low and high in microseconds of one inference, None where not known."""
    if device is None:
        measured = entry.latency(1)
        return (measured.median_us, measured.low_us, measured.high_us) if measured else None
    estimate = entry.estimate(device)
    if estimate is None or estimate.latency_us is None:
        return None
    one = estimate.latency_us
    low = one.value if one.low is None else one.low
    return one.value, low, one.value if one.high is None else one.high


def _panel(axes: Axes, board: Board, some: Sequence[Point], device: str | None) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    colours = _assigned((point.model for point in some), COLOURS)
    markers = _assigned((point.backend for point in some), MARKERS)
    for point in some:
        _draw(axes, point, colours[point.model], markers[point.backend])
    _draw_front(axes, some)
    _draw_floor(axes, board)
    _leave_out_far(axes, some, board)
    _legend(axes, colours, markers, any(point.unstable for point in some))
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(alpha=0.3, which="both")
    axes.set_title(tame(title(board)), fontsize=10)
    axes.set_ylabel("NLoS MAE (m)")
    axes.set_xlabel(_latency_label(device))


def _assigned(names: Iterable[str], looks: Sequence[str]) -> dict[str, str]:
    """Return a look for every name, in alphabetical order; they repeat when they run out."""
    return dict(zip(sorted(set(names)), cycle(looks), strict=False))


def _latency_label(device: str | None) -> str:
    if device is None:
        return "measured latency of one inference, batch 1 (µs)"
    return f"estimated latency of one inference on {tame(device)} (µs, est.)"


def _draw(axes: Axes, point: Point, colour: str, marker: str) -> None:
    axes.errorbar(
        point.latency_us,
        point.mae_m,
        xerr=_arms(point.latency_us, point.latency_low_us, point.latency_high_us),
        yerr=_arms(point.mae_m, point.mae_low_m, point.mae_high_m),
        color=colour,
        marker=marker,
        markerfacecolor="none" if point.unstable else colour,
        elinewidth=0.7,
        alpha=0.9,
    )


def _arms(value: float, low: float, high: float) -> list[list[float]]:
    """Return the error bar's lengths; an end on the wrong side of the value has length 0."""
    return [[max(0.0, value - low)], [max(0.0, high - value)]]


def _draw_front(axes: Axes, some: Sequence[Point]) -> None:
    stable = [(point.latency_us, point.mae_m) for point in some if not point.unstable]
    front = [stable[i] for i in pareto_front(stable)]
    if len(stable) < 2:
        return  # one point beats nobody: no front
    latency_us, mae_m = [x for x, _ in front], [y for _, y in front]
    axes.step(latency_us, mae_m, where="post", color="black", lw=1, label="Pareto front")


def _draw_floor(axes: Axes, board: Board) -> None:
    scored = [entry.nlos.raw_mae_m for entry in board.entries if entry.nlos is not None]
    axes.axhline(scored[0], color="grey", ls="--", lw=1, label="no mitigation")


def _leave_out_far(axes: Axes, some: Sequence[Point], board: Board) -> None:
    """End the axis above the other points where some are far worse than no mitigation; name them.

    Drawn to scale, one broken model would press all others onto one line.
    """
    raw = max(entry.nlos.raw_mae_m for entry in board.entries if entry.nlos is not None)
    far = [point for point in some if point.mae_m > FAR * raw]
    if not far or len(far) == len(some):
        return
    near = [point.mae_high_m for point in some if point not in far]
    low = min(point.mae_low_m for point in some)
    axes.set_ylim(0.9 * low, 1.08 * max(raw, *near))
    names = ", ".join(f"{one.model}/{one.backend} ({one.mae_m:.2f} m)" for one in far)
    axes.text(
        0.5, 0.99, tame(f"above the scale: {names}"), transform=axes.transAxes, fontsize=8,
        ha="center", va="top",
    )  # fmt: skip


def _legend(axes: Axes, colours: dict[str, str], markers: dict[str, str], unstable: bool) -> None:
    from matplotlib.lines import Line2D

    models = [
        Line2D([], [], color=colour, lw=4, label=tame(name)) for name, colour in colours.items()
    ]
    backends = [
        Line2D([], [], color="black", marker=marker, ls="", label=tame(name))
        for name, marker in markers.items()
    ]
    lines, _ = axes.get_legend_handles_labels()
    handles = [*models, *backends, *lines]
    if unstable:
        handles.append(
            Line2D([], [], color="black", marker="o", mfc="none", ls="", label="unstable")
        )
    axes.legend(handles=handles, fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5))
