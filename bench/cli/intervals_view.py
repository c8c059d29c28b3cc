"""What `bench run --intervals` prints."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from bench.cli.console import console

if TYPE_CHECKING:
    from bench.measure.conformal import Intervals
    from bench.runner import RunSet

HEADERS = ("model", "backend", "half width (m)", "coverage", "own coverage", "CRPS (m)")
CAPTION = (
    "split-conformal over links: calibrated on other links; coverage: share of rows inside, each "
    "link counting alike; own coverage and CRPS: of a model's own normal distribution"
)


def print_intervals(outcome: RunSet, level: float) -> None:
    """Print one row per finished run; BenchError where intervals cannot be had."""
    from bench.runner.folder import ResultFolder
    from bench.runner.intervals import intervals_of

    folder = ResultFolder(Path(outcome.folder))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, caption=CAPTION)
    for header in HEADERS:
        table.add_column(header, justify="left" if header in HEADERS[:2] else "right")
    for run in (one for one in outcome.runs if one.status == "ok"):
        found = intervals_of(folder, run, level)
        table.add_row(run.key.model, run.key.backend, *_cells(found))
    shown = console()
    shown.print(f"\nIntervals at {level:g}")
    shown.print(table)


def _cells(found: Intervals) -> tuple[str, str, str, str]:
    own = "-" if found.own_coverage is None else f"{found.own_coverage:.3f}"
    crps = "-" if found.crps_m is None else f"{found.crps_m:.4f}"
    return f"{found.half_width_m:.4f}", f"{found.coverage:.3f}", own, crps
