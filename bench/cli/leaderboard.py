"""`bench leaderboard`: result files -> Markdown, JSON and a figure."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.errors import BenchError, unknown_name
from bench.files import atomic_path, write_atomically

if TYPE_CHECKING:
    from reports import Board, Results
    from reports.document import Document


@click.command(epilog="Example: bench leaderboard --results results --out LEADERBOARD.md")
@click.option(
    "--results",
    "folder",
    type=click.Path(path_type=Path),
    default=Path("results"),
    show_default=True,
    help="Folder `bench run` wrote.",
)
@click.option("--out", type=click.Path(path_type=Path), help="Markdown file to write.")
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    help="Draw latency against NLoS MAE: writes FILE.svg and FILE.png.",
)
@click.option("--device", help="With --plot: this device's estimated latency, not the measured.")
@click.option("--machine", help="Show timings of this machine (part of its name).")
@click.option("--json", "as_json", is_flag=True, help="Print the boards as JSON.")
def command(
    folder: Path,
    out: Path | None,
    plot: Path | None,
    device: str | None,
    machine: str | None,
    as_json: bool,
) -> None:
    """Rebuild the leaderboard from result files alone.

    One table per data set and split, sorted by NLoS MAE: metres of error, microseconds of
    latency, bytes of size, millijoules of energy. Prints it unless --out is given.
    """
    from reports import ReportError, make_boards, read_results

    try:
        results = read_results(folder)
        boards = make_boards(results, machine)
        _check_device(boards, plot, device)
        pictures = _draw(boards, plot, device) if plot else []
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    _report(results, boards, out, pictures, as_json)


def _report(
    results: Results,
    boards: Sequence[Board],
    out: Path | None,
    pictures: Sequence[Path],
    as_json: bool,
) -> None:
    """Write or print the leaderboard; printed content has stdout to itself."""
    from reports.leaderboard import leaderboard
    from reports.markdown import to_markdown

    picture = _relative(pictures[0], out) if pictures else None
    document = leaderboard(boards, results.unreadable, picture)
    if out is not None:
        write_atomically(out, to_markdown(document))
    for path in (*pictures, *([out] if out else [])):
        click.echo(f"wrote {path}", err=as_json or out is None)
    if as_json:
        click.echo(json.dumps(_jsonable(_content(results, boards)), indent=1, sort_keys=True))
    elif out is None:
        _print(document)


def _print(document: Document) -> None:
    """Print tables cut to the terminal, or Markdown where the output goes elsewhere."""
    from rich.console import Console

    from reports.markdown import to_markdown
    from reports.terminal import print_document

    console = Console()
    if console.is_terminal:
        print_document(document, console)
    else:
        click.echo(to_markdown(document), nl=False)


def _draw(boards: Sequence[Board], plot: Path, device: str | None) -> list[Path]:
    """Write the figure as SVG and PNG; return both paths."""
    from rich.console import Console

    from reports.figures import latency_against_error, save_png, save_svg

    if plot.suffix not in (".svg", ".png", ""):
        raise BenchError(
            f"--plot {plot}: expected a name ending in .svg or .png (both are written)"
        )
    paths = [plot.with_suffix(".svg"), plot.with_suffix(".png")]
    with Console(stderr=True).status("drawing ..."):
        figure = latency_against_error(boards, device)
        for path, save in zip(paths, (save_svg, save_png), strict=True):
            with atomic_path(path) as scratch:
                save(figure, scratch)
    return paths


def _check_device(boards: Sequence[Board], plot: Path | None, device: str | None) -> None:
    known = {name for board in boards for name in board.devices}
    if device is not None and plot is None:
        raise BenchError("--device chooses what --plot draws: expected --plot FILE beside it")
    if device is not None and device not in known:
        raise unknown_name("device", device, known)


def _relative(picture: Path, out: Path | None) -> str:
    """Return the picture's path as seen from the report."""
    start = out.parent if out else Path()
    return Path(os.path.relpath(picture, start)).as_posix()


def _content(results: Results, boards: Sequence[Board]) -> dict[str, Any]:
    return {
        "boards": [asdict(board) for board in boards],
        "unreadable": [asdict(one) for one in results.unreadable],
    }


def _jsonable(value: Any) -> Any:
    """Return the value with what JSON cannot hold (NaN, infinity) as null."""
    if isinstance(value, dict):
        return {key: _jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_jsonable(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
