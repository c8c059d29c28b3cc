"""How a learning curve is printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.cli.console import print_table, say
from bench.results import Interval
from bench.text import named

if TYPE_CHECKING:
    from bench.runner import RunSet


def print_curve(outcome: RunSet) -> None:
    """Print a line per model, backend and number of links; errors in metres."""
    points = outcome.curve
    several = len({point.seed for point in points}) > 1
    rows = [
        (
            point.model,
            point.backend + (f", seed {point.seed}" if several else ""),
            str(point.links),
            _figure(point.nlos_mae_m, point.raw_nlos_mae_m),
            _figure(point.los_mae_m, point.raw_los_mae_m),
        )
        for point in sorted(points, key=lambda one: (one.model, one.backend, one.seed, one.links))
    ]
    title = (
        f"Learning curve on {named(points[0].data)}: {points[0].draws} draws of links; mean over "
        "draws, Student's 95 % interval, before mitigation in brackets"
    )
    print_table(title, ("model", "backend", "links", "NLoS MAE (m)", "LoS MAE (m)"), rows)
    for run in (one for one in outcome.runs if one.status == "skipped"):
        say(f"skipped: {run.key.model} on {run.key.backend}: {run.reason}")
    say(f"Results are in {named(outcome.folder)}/")


def _figure(left: Interval | None, raw_m: float | None) -> str:
    if left is None or raw_m is None:
        return "-"
    spread = f" {left.low:.3f}..{left.high:.3f}" if left.low is not None else ""
    return f"{left.value:.3f}{spread} ({raw_m:.3f})"
