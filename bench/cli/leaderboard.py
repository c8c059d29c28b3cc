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

from bench.cli.console import busy, console, say
from bench.cli.estimates import estimator
from bench.errors import BenchError, unknown_name
from bench.files import atomic_path, check_output, write_atomically
from bench.text import named

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from reports import Board, Results
    from reports.document import Document
    from reports.overview import Ranked


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
@click.option(
    "--ranks",
    type=click.Path(path_type=Path),
    help="Draw which models cannot be told apart: writes FILE.svg and FILE.png.",
)
@click.option("--device", help="With --plot: this device's estimated latency, not the measured.")
@click.option("--machine", help="Show timings of this machine (part of its name).")
@click.option("--details", is_flag=True, help="Print every column, not the short table.")
@click.option("--json", "as_json", is_flag=True, help="Print the boards as JSON.")
def command(
    folder: Path,
    out: Path | None,
    plot: Path | None,
    ranks: Path | None,
    device: str | None,
    machine: str | None,
    details: bool,
    as_json: bool,
) -> None:
    """Rebuild the leaderboard from result files alone.

    One table per data set and split, sorted by NLoS MAE (metres), with rank intervals and tie
    groups from paired differences over links, latency (microseconds) and size (kB); more rows
    than a screen has are cut to one per model, its cheapest backend. With --out
    NAME.md everything else (devices, energy, versions) goes to NAME-details.md beside it; without
    --out it is printed.
    """
    from reports import ReportError, make_boards, read_results
    from reports.condensed import condensed
    from reports.overview import ranked
    from reports.ranking.picture import tie_groups

    if out is not None:
        check_output(out)
    try:
        results = read_results(folder, estimator(folder))
        boards = make_boards(results, machine)
        _check_device(boards, plot, device)
        pictures = _draw(boards, plot, device) if plot else []
        whole = [ranked(board, results) for board in boards]
        short = [condensed(one, results) for one in whole]
        pictures += _drawn(tie_groups(short), _pair("--ranks", ranks)) if ranks else []
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    written = _write(results, whole, short, out, pictures) if out else []
    for path in (*pictures, *written):
        say(f"wrote {named(path)}", err=as_json or out is None)
    if as_json:
        say(json.dumps(_jsonable(_content(results, whole)), indent=1, sort_keys=True))
    elif out is None:
        _print(_document(results, whole if details else short, details, pictures))


def _document(
    results: Results, boards: Sequence[Ranked], details: bool, pictures: Sequence[Path]
) -> Document:
    """Return what is printed: the short leaderboard, or the one with every column."""
    from reports.overview import overview

    picture = _relative(pictures[0], None) if pictures else None
    if details:
        return _full(results, boards, picture)
    return overview(boards, None, picture, results.unreadable)


def _full(results: Results, whole: Sequence[Ranked], picture: str | None) -> Document:
    """Return the leaderboard with every row and column."""
    from reports.leaderboard import leaderboard

    boards, rankings = [one.board for one in whole], [one.ranking for one in whole]
    return leaderboard(boards, results.unreadable, picture, rankings)


def _write(
    results: Results,
    whole: Sequence[Ranked],
    short: Sequence[Ranked],
    out: Path,
    pictures: Sequence[Path],
) -> list[Path]:
    """Write the short leaderboard and its details beside it; return both paths."""
    from reports.markdown import to_markdown
    from reports.overview import overview

    more = out.with_name(f"{out.stem}-details{out.suffix}")
    picture = _relative(pictures[0], out) if pictures else None
    full = _full(results, whole, picture)
    write_atomically(out, to_markdown(overview(short, more.name, picture, results.unreadable)))
    write_atomically(more, to_markdown(full))
    return [out, more]


def _print(document: Document) -> None:
    """Print tables cut to the terminal, or Markdown where the output goes elsewhere."""
    from reports.markdown import to_markdown
    from reports.terminal import print_document

    shown = console()
    if shown.is_terminal:
        print_document(document, shown)
    else:
        say(to_markdown(document), nl=False)


def _draw(boards: Sequence[Board], plot: Path, device: str | None) -> list[Path]:
    """Write latency against error as SVG and PNG; return both paths."""
    from reports.figures import latency_against_error

    paths = _pair("--plot", plot)
    return _drawn(latency_against_error(boards, device), paths)


def _pair(option: str, path: Path) -> list[Path]:
    """Return the SVG and the PNG that a picture's name stands for."""
    if path.suffix not in (".svg", ".png", ""):
        raise BenchError(
            f"{option} {path}: expected a name ending in .svg or .png (both are written)"
        )
    return [path.with_suffix(".svg"), path.with_suffix(".png")]


def _drawn(figure: Figure, paths: list[Path]) -> list[Path]:
    """Write a figure as SVG and PNG; return both paths."""
    from reports.figures import save_png, save_svg

    with busy("drawing"):
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


def _content(results: Results, short: Sequence[Ranked]) -> dict[str, Any]:
    return {
        "boards": [asdict(one.board) | {"ranking": _ranking(one)} for one in short],
        "unreadable": [asdict(one) for one in results.unreadable],
    }


def _ranking(one: Ranked) -> dict[str, Any] | None:
    """Return ranks and tie groups; None where the models cannot be compared."""
    if one.ranking is None:
        return None
    models = [asdict(model) for model in one.ranking.models]
    return {
        "links": one.ranking.links,
        "detectable_m": one.ranking.detectable_m,
        "models": models,
        "left_out": dict(one.left_out or {}),
    }


def _jsonable(value: Any) -> Any:
    """Return the value with what JSON cannot hold (NaN, infinity) as null."""
    if isinstance(value, dict):
        return {key: _jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_jsonable(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
