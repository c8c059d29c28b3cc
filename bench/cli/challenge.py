"""`bench challenge`: put the diagnosis to the proof."""

from __future__ import annotations

import json
from pathlib import Path

import click

from bench.cli.console import say
from bench.text import named

EPILOG = """\b
Examples:
  bench challenge --cases 36 --families manege,garage --jobs 2 -o challenge
  bench challenge --cases 360 --scheduler tcp://big:8786 -o challenge
  bench challenge --real -o challenge
  bench challenge --case miluv -o challenge
  bench challenge --cases 360 --seed 7 --jobs 2 -o challenge --page challenge.md
"""
REAL = ("ghent", "outdoor", "apartment", "miluv")


@click.command(epilog=EPILOG)
@click.option("--cases", default=40, show_default=True, type=click.IntRange(1), help="Blind cases.")
@click.option(
    "--families", default="all", show_default=True, metavar="NAMES",
    help="Generators of blind cases, with commas between, such as manege,garage.",
)  # fmt: skip
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed.")
@click.option("--jobs", default=1, show_default=True, metavar="N", help="Processes.")
@click.option("--scheduler", metavar="tcp://..", help="A Dask scheduler for blind cases instead.")
@click.option("--real", is_flag=True, help="The real cases instead of blind ones.")
@click.option("--case", "only", type=click.Choice(REAL), help="Only this real case.")
@click.option(
    "-o", "--out", default="challenge", show_default=True, type=click.Path(path_type=Path),
    help="Folder; finished blind cases found there are kept.",
)  # fmt: skip
@click.option(
    "--page", type=click.Path(path_type=Path, dir_okay=False),
    help="Blind and real cases both, on one Markdown page.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the scores as JSON, nothing else.")
def command(
    cases: int,
    families: str,
    seed: int,
    jobs: int,
    scheduler: str | None,
    real: bool,
    only: str | None,
    out: Path,
    page: Path | None,
    as_json: bool,
) -> None:
    """Hide physics from the diagnosis and score what it says.

    Blind cases come from families of generators that share no code with the effect library nor
    with each other; answers are sealed by a hash before the run, and the diagnosis runs with its
    defaults. Ranges in metres, levels in dB. Real cases are recordings (see BENCH_DATA) whose
    revealing columns are hidden; those not here are left out.
    """
    from bench.challenge.api import run_challenge
    from bench.cli.status_view import StatusView

    asked = only or ("all" if real else ())
    with StatusView("challenging ...") as view:
        made = run_challenge(
            cases, seed, families=families, real=asked, out=out, page=page, jobs=jobs,
            scheduler=scheduler, observer=view,
        )  # fmt: skip
    if as_json:
        say(json.dumps(made.scores, indent=1))
    else:
        say("\n".join(made.lines))
        say(f"report: {named(made.report)}", err=True)
