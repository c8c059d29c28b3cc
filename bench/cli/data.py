"""`bench data`: list, describe, import and fetch recordings."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli.console import busy, console, say
from bench.errors import BenchError, foreign
from bench.text import named

if TYPE_CHECKING:
    from bench.recordings import Recordings
    from bench.recordings.describe import Description, ErrorStatistics
    from bench.recordings.sources.base import Source

SHOWN = (5, 50, 95)  # percentiles in the table; all of them stand in the JSON
IMPORT_EPILOG = """\b
Examples:
  bench data import apartment -o apartment.parquet
  bench data import log.csv -o own.parquet --link tx,rx \\
      --map range=dist_mm:mm,true_range=truth:cm
"""
AS_JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")


@click.group(
    epilog="Example: bench data info rooms --plot rooms.png",
    context_settings={"help_option_names": ["-h", "--help"]},
)
def command() -> None:
    """List, describe, import and fetch recordings.

    A data set is named (`bench data list`) or is a recordings file: Parquet or CSV with a column
    per quantity, its unit in its name: range_m, true_range_m (or error_m), cir, link, ...
    """


@command.command(
    "list",
    short_help="List the named data sets and what is here.",
    epilog="Example: bench data list --json",
)
@AS_JSON
def list_command(as_json: bool) -> None:
    """List the named data sets and whether they are on this machine."""
    rows = list(_listed())
    if as_json:
        say(json.dumps(rows, indent=1))
        return
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("data set", "on this machine", "what it is", "licence"):
        table.add_column(heading, overflow="fold")
    for row in rows:
        here = Text("yes", "green") if row["available"] else Text("no", "yellow")
        table.add_row(row["name"], here, row["title"], row["licence"])
    console().print(table)
    for row in rows:
        for line in _remarks(row):
            console().print(f"{row['name']}: {line}", soft_wrap=True)


def _remarks(row: dict[str, Any]) -> Iterator[str]:
    """Yield how to get a data set, its variants, and whether its reader saw a real file."""
    if not row["available"]:
        yield row["reason"]
    for variant, what in row.get("variants", {}).items():
        yield f"also as {row['name']}:{variant}, {what}"
    if row.get("untested"):
        yield f"UNTESTED: {row['untested']}"


def _listed() -> Iterator[dict[str, Any]]:
    """Yield one entry per registered data set; one that fails to import says why."""
    from bench.plugins import plugins
    from bench.recordings.sources.base import open_source

    for plugin in plugins("datasets"):
        entry: dict[str, Any] = {"name": plugin.name, "title": "", "licence": ""}
        try:
            with foreign(f"data set {plugin.name!r} is unavailable"):
                source = open_source(plugin.name)
                mark = " (SIMULATED)" if source.simulated else ""
                entry |= {"title": source.title + mark, "licence": source.licence}
                entry |= {"variants": dict(source.variants), "untested": source.untested}
                reason = source.available()
        except BenchError as error:
            reason = str(error)
        yield entry | {"available": reason is None, "reason": reason}


@command.command(
    short_help="Describe recordings: rows, links, range errors; draw them.",
    epilog="Example: bench data info apartment --plot apartment.png",
)
@click.argument("name_or_path", metavar="NAME|PATH")
@click.option(
    "--plot", type=click.Path(path_type=Path), help="Draw CIRs and errors to a .png, .svg or .pdf."
)
@AS_JSON
def info(name_or_path: str, plot: Path | None, as_json: bool) -> None:
    """Describe recordings: rows, links, what was dropped and why, and range errors in metres.

    Error = measured - true range: positive reads long.
    """
    from bench.recordings.describe import describe_recordings

    recordings, source = _open(name_or_path)
    found = describe_recordings(recordings)
    if plot:
        from bench.recordings.picture import save_picture

        with busy(f"Drawing {plot}"):
            save_picture(recordings, plot)
    if as_json:
        say(json.dumps(asdict(found), indent=1))
        return
    _print_facts(found, source)
    _print_errors(found)
    if plot:
        say(f"picture: {named(plot)}")


def _print_facts(found: Description, source: Source | None) -> None:
    """Print the size of the table and where it comes from."""
    from rich.text import Text

    from bench.recordings.clean import describe

    shown = console()
    mark = ("  SIMULATED", "bold yellow") if found.simulated else ""
    title = f"  {source.title}" if source else ""
    shown.print(Text.assemble((named(found.source), "bold"), mark, title))
    cir = "none"
    if found.cir_samples is not None:
        cir = f"{found.cir_samples} samples of {found.sample_period_ns:.4f} ns"
    facts = {
        "rows": str(found.rows),
        "links": "no link column" if found.links is None else str(found.links),
        "dropped": describe(found.dropped) or "none",
        "CIR": cir,
        "licence": found.licence,
        "fingerprint": found.fingerprint,
        "columns": ", ".join(found.columns),
    }
    for name, value in facts.items():
        shown.print(f"{name:<12} {named(value)}", soft_wrap=True)


def _print_errors(found: Description) -> None:
    """Print the error statistics as a table."""
    from rich.table import Table

    mark = ", SIMULATED" if found.simulated else ""
    table = Table(
        title=f"Range error = measured - true, in metres{mark}",
        title_justify="left",
        box=None,
        pad_edge=False,
        header_style="bold",
    )
    table.add_column("environment", no_wrap=True)
    table.add_column("kind", no_wrap=True)
    for heading in ("rows", "links", "mean", "MAE", "sigma", *(f"p{p}" for p in SHOWN)):
        table.add_column(heading, justify="right", no_wrap=True)
    for line in found.errors:
        table.add_row(*_cells(line))
    console().print()
    console().print(table)


def _cells(line: ErrorStatistics) -> list[str]:
    """Return one line of the table as text, metres with three decimals."""
    lengths = [line.mean_m, line.mae_m, line.sigma_m, *(line.percentiles_m[p] for p in SHOWN)]
    links = "-" if line.links is None else str(line.links)
    texts = [f"{length:.3f}" for length in lengths]
    return [line.environment, line.kind, str(line.rows), links, *texts]


@command.command(
    "import",
    short_help="Write a data set, your own logs or a folder of them as recordings Parquet.",
    epilog=IMPORT_EPILOG,
)
@click.argument("source", metavar="NAME|FILE|FOLDER")
@click.option(
    "-o",
    "--out",
    required=True,
    type=click.Path(path_type=Path),
    help="Recordings Parquet to write.",
)
@click.option(
    "--map",
    "maps",
    multiple=True,
    metavar="NAME=COLUMN[:UNIT],..",
    help="Which column is what, and its unit: range=dist_mm:mm. los=label:not turns it round; "
    "first_path_index=FP:10.6 reads fixed point.",
)
@click.option(
    "--csv",
    metavar="MARKS",
    help="Field delimiter and decimal mark, such as ';,' or 'tab,'; found by itself otherwise.",
)
@click.option("--link", metavar="COLUMN,..", help="Columns that tell links apart: tx,rx,position.")
@click.option(
    "--link-by",
    metavar="time:DURATION|grid:LENGTH",
    help="Cut moving pairs into links: stretches of time (time:20s) or cells of place (grid:1m).",
)
@click.option(
    "--from-name",
    metavar="REGEX",
    help="Columns out of file names, by named groups: '(?P<distance>[0-9.]+)m'.",
)
@click.option("--json", "as_json", is_flag=True, help="Print what was imported as JSON.")
def import_command(source: str, out: Path, link: str | None, as_json: bool, **texts: Any) -> None:
    """Write a named data set, your own log, or a folder of logs of one form as Parquet.

    Text tables: any delimiter, decimal commas, a CIR in one cell ([12, 15.5, 9] or 12 15.5 9) or
    in columns cir_0 .. cir_N. Raw registers of a DW1000 (FP_INDEX, FP_AMPL1..3, CIR_PWR, RXPACC)
    become first path and levels. Rows of a folder also have the columns `file` and `folder`.
    """
    from bench.cli.data_import import import_one, print_imported
    from bench.recordings.logs.read import LogOptions

    columns = tuple(name.strip() for name in link.split(",")) if link else ()
    with busy(f"Reading {source}"):
        imported = import_one(source, out, LogOptions(link=columns, **texts))
    print_imported(imported, out, as_json)


@command.command(
    short_help="Download a data set from its publisher, checked.",
    epilog="Example: bench data fetch deepuwb",
)
@click.argument("name", metavar="NAME")
@click.option("--sha256", help="Checksum of the file, where the publisher gives none.")
@click.option(
    "--accept-unverified",
    is_flag=True,
    help="Download files whose checksum is not known, without a check.",
)
def fetch(name: str, sha256: str | None, accept_unverified: bool) -> None:
    """Download a data set from its publisher, checked against the publisher's checksums.

    An interrupted download continues where it stopped. Without a network it says what to download
    by hand and where to put it.
    """
    from bench.recordings.fetch import fetch as download
    from bench.recordings.sources.base import download_folder, open_source

    source = open_source(name)
    with _downloads() as progress:
        files = download(source, accept_unverified, sha256, progress)
    say(f"{name}: {len(files)} files in {download_folder(name)}")
    if missing := source.available():
        raise BenchError(f"{name}: downloaded, but not as expected: {missing}")
    say(f"Look at it with: bench data info {name}")


def _open(name_or_path: str) -> tuple[Recordings, Source | None]:
    """Open recordings with a sign of life on stderr."""
    from bench.recordings.open import open_recordings

    with busy(f"Reading {name_or_path}"):
        return open_recordings(name_or_path)


@contextmanager
def _downloads() -> Iterator[Any]:
    """Show a bar per file on stderr; yields what to call with name, bytes so far, bytes in all."""
    from rich import progress as bars

    columns = (
        bars.TextColumn("{task.description}", markup=False),
        bars.BarColumn(),
        bars.DownloadColumn(),
        bars.TransferSpeedColumn(),
        bars.TimeRemainingColumn(),
    )
    shown = bars.Progress(*columns, console=console(stderr=True))
    tasks: dict[str, bars.TaskID] = {}

    def advance(name: str, done: int, total: int | None) -> None:
        shown.start()  # only now: an error before the first byte stays one line
        if name not in tasks:
            tasks[name] = shown.add_task(name, total=total)
        shown.update(tasks[name], completed=done, total=total)

    try:
        yield advance
    finally:
        if tasks:
            shown.stop()
