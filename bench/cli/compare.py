"""`bench compare`: two result folders or two runs, difference by difference."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli.console import console, say
from bench.errors import BenchError
from bench.files import atomic_path, check_output, write_atomically
from bench.text import named

if TYPE_CHECKING:
    from reports.document import Document
    from reports.ranking.compare import Comparison, Difference

LEVEL = 0.05


@click.command(
    epilog="Examples:\n\n  bench compare results-before results-after\n\n"
    "  bench compare results/runs/1f0c.json results/runs/9ab3.json\n\n"
    "  bench compare results --against gbm --out tables.md --plot together.png"
)
@click.argument("first", type=click.Path(path_type=Path))
@click.argument("second", type=click.Path(path_type=Path), required=False)
@click.option("--against", metavar="MODEL", help="Compare every model of FIRST with this one.")
@click.option("--backend", default="fp32", show_default=True, help="With --against: the backend.")
@click.option("--out", type=click.Path(path_type=Path), help="With --against: Markdown to write.")
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    help="With --against: draw the differences on all data sets (.png, .svg).",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed.")
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON.")
def command(
    first: Path,
    second: Path | None,
    against: str | None,
    backend: str,
    out: Path | None,
    plot: Path | None,
    seed: int,
    as_json: bool,
) -> None:
    """Compare two result folders, or two run records, on the same rows.

    With --against MODEL: every model of one folder with that one, a table per data set and one of
    all of them together.

    Differences of MAE in metres (negative: SECOND is better) with 95 % intervals over links, the
    chance of such a difference where there is none (adjusted for all comparisons), and the ratio
    of latencies on one machine. What is not comparable (other recordings, another split, another
    machine for timings) is refused by name.
    """
    from reports import ReportError
    from reports.ranking.compare import compare

    for source in (first, second):
        if source is not None and not source.exists():
            raise BenchError(f"{source} is not here: expected a result folder or a run record")
    if against is not None and not (as_json or second):
        _picture(first, against, backend, plot, seed)
        _tables(first, against, backend, out, seed)
        return
    if second is None or against is not None or out is not None or plot is not None:
        raise BenchError(
            "expected FIRST and SECOND, or FIRST with --against MODEL [--out FILE] [--plot FILE]"
        )
    try:
        found = compare(first, second, seed)
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    if as_json:
        say(json.dumps(_content(found), indent=1, default=str))
        return
    _print(_document(found, first, second))


def _tables(folder: Path, model: str, backend: str, out: Path | None, seed: int) -> None:
    """Print or write every model of a folder against one of them."""
    from reports import ReportError, read_results
    from reports.against import against
    from reports.markdown import to_markdown

    if out is not None:
        check_output(out)
    try:
        made = against(read_results(folder), model, backend, seed)
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    if out is None:
        _print(made)
        return
    write_atomically(out, to_markdown(made))
    say(f"wrote {named(out)}")


def _picture(folder: Path, model: str, backend: str, plot: Path | None, seed: int) -> None:
    """Draw every model of a folder against one of them, where asked for."""
    if plot is None:
        return
    from reports import ReportError, read_results
    from reports.against import shares
    from reports.figures import save_png, save_svg
    from reports.together_picture import draw

    savers = {".png": save_png, ".svg": save_svg}
    if plot.suffix not in savers:
        raise BenchError(f"--plot {plot}: expected a name that ends with .png or .svg")
    check_output(plot)
    try:
        figure = draw(shares(read_results(folder), model, backend, seed), model)
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    with atomic_path(plot) as scratch:
        savers[plot.suffix](figure, scratch)
    say(f"wrote {named(plot)}")


def _print(document: Document) -> None:
    from reports.terminal import print_document

    print_document(document, console())


def _content(found: Comparison) -> dict[str, Any]:
    """Return the comparison as plain data."""
    return {
        "differences": [_plain(one) for one in found.differences],
        "refused": list(found.refused),
        "left_out": list(found.left_out),
    }


def _plain(one: Difference) -> dict[str, Any]:
    return {
        "first": one.first.name,
        "second": one.second.name,
        "simulated": one.first.simulated,
        "rows": one.rows,
        "links": one.links,
        "mae_m": list(one.mae_m),
        "difference_m": asdict(one.difference_m),
        "p_adjusted": one.p,
        "latency_ratio": asdict(one.latency) if one.latency else None,
        "latency_note": one.latency_reason,
        "file_size_ratio": one.size_ratio,
    }


def _document(found: Comparison, first: Path, second: Path) -> Document:
    from reports.document import Bullets, Cell, Column, Heading, Paragraph, Table, bounded

    columns = (
        Column("Run", number=False),
        Column("Rows", "error", number=False),
        Column("MAE first (m)", "error"),
        Column("MAE second (m)", "error"),
        Column("Difference (m)", "error"),
        Column("p (adjusted)", "error"),
        Column("Latency ratio", "cost"),
        Column("File ratio", "cost"),
    )
    rows = tuple(
        tuple(Cell(text, details) for text, details in _cells(one)) for one in found.differences
    )
    document: Document = [
        Heading(f"{second} against {first}", 1),
        Table(columns, rows),
        Paragraph(
            "Difference: MAE of the second minus that of the first on the same rows, with its 95 % "
            "interval over links; p: chance of as much where there is none, adjusted for all rows "
            "of this table."
        ),
    ]
    if found.refused:
        document += [Paragraph("Not compared:"), Bullets(found.refused)]
    if found.left_out:
        document += [Paragraph(f"Files left out: {len(found.left_out)}"), bounded(found.left_out)]
    return document


def _cells(one: Difference) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the text and the details of every cell of a row."""
    kind = " (SIMULATED)" if one.first.simulated else ""
    told = () if one.first.name == one.second.name else (f"against {one.second.name}",)
    yield f"{one.first.name}{kind}", told
    yield f"{one.rows}, {one.links} links", ()
    yield f"{one.mae_m[0]:.4f}", ()
    yield f"{one.mae_m[1]:.4f}", ()
    gap = one.difference_m
    yield f"{gap.value:+.4f}", _ends(gap.low, gap.high, "+.4f")
    yield ("< 0.001" if one.p < 0.001 else f"{one.p:.3f}"), ()
    if one.latency is None:
        yield "-", (one.latency_reason,)
    else:
        ends = _ends(one.latency.low, one.latency.high, ".3f")
        yield f"{one.latency.value:.3f}", (*ends, one.latency_reason)
    yield ("-" if one.size_ratio is None else f"{one.size_ratio:.3f}"), ()


def _ends(low: float | None, high: float | None, form: str) -> tuple[str, ...]:
    if low is None or high is None:
        return ()
    return (f"[{low:{form}}, {high:{form}}]",)
