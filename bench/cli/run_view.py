"""What `bench run` shows: progress while it works, a summary table at the end."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from rich import box
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

from bench.cli.console import console, say
from bench.results import Estimate, Interval, RunRecord, TimingRecord
from bench.runner.observer import Observer
from bench.text import named

if TYPE_CHECKING:
    from bench.runner import RunSet
    from reports.document import Table as Figures


class RunView(Observer):
    """Shows stages, runs done and the current fit's fraction on stderr; in a log, a line a step."""

    def __init__(self, quiet: bool) -> None:
        shown = console(stderr=True, quiet=quiet)
        self._bars = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            TextColumn("{task.fields[figure]}", markup=False),
            TimeElapsedColumn(),
            console=shown,
            transient=True,
            disable=quiet or not shown.is_terminal,
        )
        self._overall: TaskID | None = None
        self._current: TaskID | None = None
        self._logged = "" if not quiet and self._bars.disable else None

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._bars.stop()

    def stage(self, what: str) -> None:
        """Show work that has no fraction as a pulsing bar."""
        self._show_current(what, None)

    def runs(self, done: int, total: int) -> None:
        """Show how many runs are finished."""
        if self._overall is None:
            self._overall = self._bars.add_task("runs", figure="")
        self._bars.update(self._overall, total=total, completed=done, figure=f"{done}/{total}")

    def progress(self, what: str, fraction: float) -> None:
        """Show the fraction done of the current work."""
        self._show_current(what, fraction)

    def note(self, line: str) -> None:
        """Print a line that stays."""
        self._bars.console.print(line)

    def _show_current(self, what: str, fraction: float | None) -> None:
        if self._logged is not None and what != self._logged:
            say(what, err=True)
            self._logged = what
        figure = "" if fraction is None else f"{100 * fraction:3.0f} %"
        total = None if fraction is None else 1.0
        if self._current is None:
            self._current = self._bars.add_task(what, figure=figure)
        self._bars.update(
            self._current, description=what, total=total, completed=fraction or 0.0, figure=figure
        )


def print_json(outcome: RunSet) -> None:
    """Print every record as one JSON object."""
    from bench.results import to_json

    content = {
        "runs": [_with_estimates(one, outcome) for one in outcome.runs],
        "timings": [json.loads(to_json(one)) for one in outcome.timings],
        "failures": [vars(one) for one in outcome.failures],
        "curve": [asdict(one) for one in outcome.curve],
    }
    say(json.dumps(content, indent=1))


def _with_estimates(run: RunRecord, outcome: RunSet) -> dict[str, Any]:
    """Return a record as it stands in its file, with estimates for the devices asked for."""
    from bench.results import to_json

    estimates = [asdict(one) for one in outcome.estimates(run)]
    return {**json.loads(to_json(run)), "estimates": estimates}


def print_summary(outcome: RunSet) -> None:
    """Print a table of runs, a table of device estimates for one run, and where files are."""
    shown = console()
    done = [run for run in outcome.runs if run.status == "ok"]
    if done:
        shown.print(_title(done[0]))
        _print_accuracy(done, outcome.timings)
    for note in dict.fromkeys(
        f"{r.key.model} on {r.key.backend}: {r.note}" for r in done if r.note
    ):
        shown.print(note, soft_wrap=True)
    if len(done) == 1:
        shown.print(_device_table(outcome.estimates(done[0])))
    for run in (one for one in outcome.runs if one.status == "skipped"):
        say(f"skipped: {run.key.model} on {run.key.backend}: {run.reason}")
    where = "" if outcome.folder == Path("results") else f" --results {named(outcome.folder)}"
    say(f"Results are in {named(outcome.folder)}/; a leaderboard of them: bench leaderboard{where}")


def _title(run: RunRecord) -> str:
    kind = "SIMULATED data" if run.simulated else "recordings"
    lines = [f"\n{kind} {named(run.key.data)}, split {named(run.key.split)}"]
    for name, score in (("NLoS", run.nlos), ("LoS", run.los)):
        if score is not None:
            lines.append(
                f"  {name}: {score.rows} rows on {score.links} links; before mitigation "
                f"MAE {score.raw_mae_m:.4f} m, sigma {score.raw_sigma_m:.4f} m"
            )
    return "\n".join(lines)


def _print_accuracy(runs: Sequence[RunRecord], timings: Iterable[TimingRecord]) -> None:
    """Print the figures side by side, in as many tables as the width takes: none is ever cut."""
    from reports.terminal import parts

    shown = console()
    for part in parts(_accuracy_table(runs, timings), shown.width):
        shown.print(part)
    shown.print("below a figure: 95 % interval over links; latency: measured here, one thread")


def _accuracy_table(runs: Sequence[RunRecord], timings: Iterable[TimingRecord]) -> Figures:
    from reports.document import Cell, Column
    from reports.document import Table as Figures

    timed = {(one.model, one.backend, one.data): one for one in timings}
    several = len({run.key.seed for run in runs}) > 1
    keys = ["model", "backend", *(["seed"] if several else [])]
    titles = ["NLoS MAE (m)", "R2", "sigma (m)", "LoS MAE (m)", "latency (us)", "file (kB)"]
    columns = [Column(key, number=False) for key in keys]
    columns += [Column(title, "figures") for title in titles]
    rows = []
    for run in runs:
        timing = timed.get((run.key.model, run.key.backend, run.key.data))
        names = [run.key.model, run.key.backend, *([str(run.key.seed)] if several else [])]
        cells = [text.split("\n") for text in (*names, *_figures(run, timing))]
        rows.append(tuple(Cell(first, details=tuple(rest)) for first, *rest in cells))
    return Figures(tuple(columns), tuple(rows))


def _figures(run: RunRecord, timing: TimingRecord | None) -> list[str]:
    nlos, los = run.nlos, run.los
    return [
        _stacked(nlos.mae_m) if nlos else "-",
        f"{nlos.r2.value:.3f}" if nlos else "-",
        f"{nlos.sigma_m.value:.4f}" if nlos else "-",
        _stacked(los.mae_m) if los else "-",
        _latency(timing),
        f"{run.size.file_bytes / 1000:.1f}" if run.size else "-",
    ]


def _stacked(figure: Interval) -> str:
    """Return the figure with its interval on a second line, narrow enough for 80 columns."""
    if figure.low is None or figure.high is None:
        return f"{figure.value:.4f}"
    return f"{figure.value:.4f}\n{figure.low:.3f}-{figure.high:.3f}"


def _interval(figure: Interval, digits: int) -> str:
    text = f"{figure.value:.{digits}f}"
    if figure.low is None or figure.high is None:
        return text
    return f"{text} ({figure.low:.{digits}f}..{figure.high:.{digits}f})"


def _latency(timing: TimingRecord | None) -> str:
    if timing is None or not timing.latency:
        return "machine\nbusy" if timing and timing.withheld else "-"
    one = timing.latency[0]
    return f"{one.median_us:.1f}" + ("\nunstable" if one.unstable else "")


def _device_table(estimates: Iterable[Estimate]) -> Table:
    table = Table(
        box=box.SIMPLE_HEAD,
        pad_edge=False,
        title="On devices that are not here (batch 1), none of it measured",
        caption="counted: emulated, cycles by the core's table; estimated: from a device profile; "
        "low..high: the range of the table or the profile",
    )
    some = list(estimates)
    for title in ("device", "how", "latency (us)", "energy (mJ)"):
        table.add_column(title, justify="left" if title in ("device", "how") else "right")
    for one in some:
        table.add_row(*_device_cells(one))
    for one in (one for one in some if one.fits):
        table.caption = f"{table.caption}\n{one.device}: {one.fits}"
    return table


def _device_cells(one: Estimate) -> Iterable[Any]:
    if one.latency_us is None or one.energy_mj is None:
        return one.device, one.how, f"- ({one.reason})", "-"
    return one.device, one.how, _interval(one.latency_us, 0), _interval(one.energy_mj, 3)
