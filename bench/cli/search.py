"""`bench search`: smaller networks, error against counted cycles and flash."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from bench.cli.console import console, say
from bench.errors import BenchError
from bench.text import named

if TYPE_CHECKING:
    from reports.search import SearchFile

EPILOG = """\b
Examples:
  bench search
  bench search --candidates 12 --epochs 3 --final-epochs 10 --finalists 3 --quick
  bench search --data apartment --device stm32l4 --jobs 2 --page docs/search.md
"""


@click.command(epilog=EPILOG)
@click.option(
    "--data",
    default="rooms",
    show_default=True,
    metavar="NAME|PATH",
    help="Recordings with CIRs (SIMULATED by default).",
)
@click.option("--split", metavar="SPLIT", help="As `bench run`; the first fold is used.")
@click.option("--device", default="nrf52832", show_default=True, metavar="NAME", help="A part.")
@click.option(
    "--compiler",
    type=click.Choice(["auto", "gcc", "zig"]),
    default="auto",
    show_default=True,
    help="auto: gcc where installed, else zig cc.",
)
@click.option("--candidates", default=36, show_default=True, metavar="N", help="Networks drawn.")
@click.option("--levels", default=2, show_default=True, metavar="N", help="Levels of training.")
@click.option("--epochs", default=12, show_default=True, metavar="N", help="Of the last level.")
@click.option("--finalists", default=6, show_default=True, metavar="N", help="Judged and counted.")
@click.option(
    "--final-epochs", default=30, show_default=True, metavar="N", help="Epochs of finalists."
)
@click.option(
    "--calibrate", default=8, show_default=True, metavar="N", help="Networks counted beforehand."
)
@click.option("--seed", default=0, show_default=True, metavar="N", help="Draws and training.")
@click.option("--quick", is_flag=True, help="Fewer rows (whole links), kept apart.")
@click.option(
    "--out",
    default="results",
    show_default=True,
    type=click.Path(path_type=Path),
    help="Result folder; networks trained or counted before are reused.",
)
@click.option("--jobs", default=1, show_default=True, metavar="N", help="Processes.")
@click.option("--scheduler", metavar="tcp://..", help="A Dask scheduler instead.")
@click.option(
    "--page",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.md",
    help="Write the front as a page too, its picture in the folder FILE beside it.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the search as JSON, nothing else.")
def command(
    data: str,
    split: str | None,
    device: str,
    compiler: Literal["auto", "gcc", "zig"],
    candidates: int,
    levels: int,
    epochs: int,
    finalists: int,
    final_epochs: int,
    calibrate: int,
    seed: int,
    quick: bool,
    out: Path,
    jobs: int,
    scheduler: str | None,
    page: Path | None,
    as_json: bool,
) -> None:
    """Search for smaller networks: MAE (m) against counted cycles and flash (bytes).

    Networks are drawn with the seed, judged on held-out training links at rising numbers of
    epochs, and thinned to the front; the finalists are trained in full, their 8-bit C judged on
    the test rows and counted in an emulator, beside REMnet. Interrupted? The same command
    finishes the rest.
    """
    from bench.cli.reproduce_page import check_page
    from bench.cli.run_view import RunView
    from bench.parallel import Spread
    from bench.reproduce.context import Context
    from bench.search.api import Settings, search

    if page is not None:
        check_page(page)
    settings = Settings(
        *(candidates, levels, epochs, final_epochs, finalists),
        calibrate=calibrate,
        device=device,
        compiler=compiler,
        seed=seed,
    )
    with RunView(quiet=as_json) as view:
        context = Context(data, out, split, quick, view, Spread(jobs, scheduler), device)
        content = search(context, settings)
    path = context.folder / "search.json"
    found = _written(content, path)
    if page is not None:
        _write_page(found, page)
    if as_json:
        return say(json.dumps(content, indent=1))
    return _print(found, path)


def _written(content: dict[str, Any], path: Path) -> SearchFile:
    """Write the search and return it as it is read back."""
    from bench.files import write_atomically
    from bench.provenance import sealed
    from reports import ReportError
    from reports.search import read_search

    plain = json.loads(json.dumps(content))
    write_atomically(path, json.dumps(sealed(plain), indent=1) + "\n")
    try:
        return read_search(path)
    except ReportError as problem:
        raise BenchError(str(problem)) from problem


def _write_page(found: SearchFile, page: Path) -> None:
    from bench.files import atomic_path, write_atomically
    from reports.figures import save_png
    from reports.markdown import to_markdown
    from reports.search import search_page, search_picture

    picture = page.with_suffix("") / "front.png"
    with atomic_path(picture) as scratch:
        save_png(search_picture(found), scratch)
    write_atomically(page, to_markdown(search_page(found, f"{page.stem}/front.png")))


def _print(found: SearchFile, path: Path) -> None:
    from reports.search import search_page
    from reports.terminal import print_document

    print_document(search_page(found, None), console())
    say(f"The search is in {named(path)}")
