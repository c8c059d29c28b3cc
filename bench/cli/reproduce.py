"""`bench reproduce`: the paper's tables and figures on any recordings."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import console, print_json, say
from bench.errors import BenchError
from bench.files import atomic_path, write_atomically
from bench.text import named

if TYPE_CHECKING:
    from bench.reproduce.api import Reproduction

EPILOG = """\b
Examples:
  bench reproduce optimisation --quick
  bench reproduce all --data rooms --out results
  bench reproduce cir-size,generalisation --jobs 2
  bench reproduce latency-vs-accuracy --device host
  bench reproduce all --page docs/reproduce.md
"""


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.argument("names", metavar="NAME[,..]|all", required=False)
@click.option("--list", "listed", is_flag=True, help="List the experiments.")
@click.option(
    "--data",
    default="rooms",
    show_default=True,
    metavar="NAME|PATH",
    help="A data set (`bench data list`) or a recordings .parquet or .csv.",
)
@click.option("--split", metavar="SPLIT", help="As in `bench run`; default: what suits the data.")
@click.option("--quick", is_flag=True, help="Fewer rows (whole links) and points, marked QUICK.")
@click.option(
    "--out",
    default="results",
    show_default=True,
    type=click.Path(path_type=Path),
    help="Result folder; runs and sweep points found there are reused.",
)
@click.option(
    "--jobs", default=1, show_default=True, metavar="N", help="Processes for fits and sweeps."
)
@click.option(
    "--scheduler", metavar="tcp://..", help="A Dask scheduler for fits and sweeps instead."
)
@click.option(
    "--device",
    default="cortex-a53",
    show_default=True,
    metavar="NAME[,..]",
    help="For latency-vs-accuracy: devices (`bench devices`; ESTIMATES), or host (measured).",
)
@click.option(
    "--page",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.md",
    help="Write these experiments as one page too, its pictures in the folder FILE beside it.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the outcomes as JSON, nothing else.")
def command(
    names: str | None,
    listed: bool,
    data: str,
    split: str | None,
    quick: bool,
    out: Path,
    jobs: int,
    scheduler: str | None,
    device: str,
    page: Path | None,
    as_json: bool,
) -> None:
    """Redo the paper's tables and figures, each beside the paper's own numbers.

    Writes a Markdown page per experiment with its pictures (SVG, PNG), and `reproduce.md` over
    all. Errors are in m, latencies in us, energies in mJ. Interrupted? The same command finishes
    the rest.
    """
    from bench.cli.reproduce_page import check_page, write_page
    from bench.cli.run_view import RunView
    from bench.parallel import Spread
    from bench.reproduce.api import reproduce
    from bench.reproduce.catalogue import chosen
    from bench.reproduce.context import Context
    from bench.reproduce.device_figures import chosen_devices

    if listed:
        return _list(as_json)
    if names is None:
        raise BenchError("no experiment named: expected NAME[,..] or all (--list shows them)")
    if page is not None:
        check_page(page)
    experiments, spread = chosen(names), Spread(jobs, scheduler)
    devices = ",".join(chosen_devices(device))
    with RunView(quiet=as_json) as view:
        done = reproduce(experiments, Context(data, out, split, quick, view, spread, devices))
        view.stage("drawing")
        pages = _render(done)
        if page is not None:
            write_page(page, done)
    return _tell(done, pages, as_json)


def _list(as_json: bool) -> None:
    from bench.reproduce.catalogue import experiments

    found = {one.name: one.summary for one in experiments()}
    if as_json:
        print_json(found)
    for name, summary in found.items() if not as_json else ():
        say(f"{name:<22} {summary}")


def _render(done: Reproduction) -> list[Path]:
    """Write a page per outcome, its pictures, and the page over all; return the pages."""
    from reports import ReportError
    from reports.markdown import to_markdown
    from reports.reproduction import index_page, outcome_page, pictures, read_outcomes

    try:
        outcomes = read_outcomes(done.folder)
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    texts = {f"{one.experiment}.md": outcome_page(one) for one in outcomes}
    for one in outcomes:
        for name, save in pictures(one):
            with atomic_path(done.folder / name) as scratch:
                save(scratch)
    texts["reproduce.md"] = index_page(outcomes, done.impossible)
    for name, document in texts.items():
        write_atomically(done.folder / name, to_markdown(document))
    return [done.folder / name for name in texts]


def _tell(done: Reproduction, pages: list[Path], as_json: bool) -> None:
    """Print the outcomes asked for, and where everything is."""
    if as_json:
        contents = [json.loads(path.read_text(encoding="utf-8")) for path in done.files]
        refused = [{"experiment": name, "reason": why} for name, why in done.impossible]
        say(json.dumps({"outcomes": contents, "impossible": refused}, indent=1))
        return
    from reports.reproduction import outcome_page, read_outcome
    from reports.terminal import print_document

    for path in done.files:
        print_document(outcome_page(read_outcome(path), pictured=False), console())
    for name, why in done.impossible:
        say(f"not possible: {name}: {why}")
    say(f"Pages and pictures are in {named(done.folder)}/; start at {named(pages[-1])}")
