"""`bench site`: a result folder as one self-contained page."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import busy, say
from bench.cli.estimates import estimator
from bench.errors import BenchError
from bench.files import write_atomically
from bench.text import named

if TYPE_CHECKING:
    from reports.site import Page

MOST_BYTES = 5_000_000


@click.command(epilog="Example: bench site --results results -o site --report docs/challenge.md")
@click.option(
    "--results",
    "folder",
    type=click.Path(path_type=Path),
    default=Path("results"),
    show_default=True,
    help="Folder `bench run` wrote.",
)
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("site"),
    show_default=True,
    help="Folder; the page is index.html in it.",
)
@click.option(
    "--report",
    "reports",
    type=click.Path(path_type=Path),
    multiple=True,
    help="A Markdown report to show beside: a diagnosis, the challenge. May be given again.",
)
@click.option("--machine", help="Show timings of this machine (part of its name).")
@click.option("--json", "as_json", is_flag=True, help="Print the page's data as JSON instead.")
def command(
    folder: Path, out: Path, reports: tuple[Path, ...], machine: str | None, as_json: bool
) -> None:
    """Write one page that needs no network: every data set and split, sorted and filtered.

    With an explorer of error (metres) against latency (microseconds), size (kB) and energy
    (millijoules), and a view of every run: residuals by distance, level and link, calibration,
    kernels, and how each figure was obtained.
    """
    import json

    from reports import ReportError, make_boards, read_results
    from reports.overview import ranked
    from reports.site import payload, render

    pages = [_page(path) for path in reports]
    with busy("making the page"):
        try:
            results = read_results(folder, estimator(folder))
            data = payload(results, [ranked(one, results) for one in make_boards(results, machine)])
        except ReportError as problem:
            raise BenchError(str(problem)) from problem
    if as_json:
        say(json.dumps(data, indent=1))
        return
    made = f"Made by bench site, {datetime.now(UTC):%Y-%m-%d %H:%M} UTC."
    path = out / "index.html"
    write_atomically(path, render(data, pages, made))
    say(f"wrote {named(path)} ({path.stat().st_size / 1e6:.2f} MB)")


def _page(path: Path) -> Page:
    """Return a Markdown report. Raises BenchError where it cannot be read."""
    from reports.site import Page

    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            raise BenchError(f"--report {path}: expected a Markdown file of at most 5 MB")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as problem:
        raise BenchError(f"--report {path}: expected a Markdown file ({problem})") from problem
    title = next((line.lstrip("# ") for line in text.splitlines() if line.startswith("#")), "")
    return Page(title[:60] or path.stem, text)
