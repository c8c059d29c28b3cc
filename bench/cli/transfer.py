"""`bench transfer`: trained on each data set, tested on each other."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import print_table, say
from bench.text import named

if TYPE_CHECKING:
    from bench.results import Score
    from bench.runner.transfer import TransferMatrix


@click.command(epilog="Example: bench transfer --model gbm --plot transfer.png")
@click.option("--model", default="gbm", show_default=True, metavar="NAME", help="`bench models`")
@click.option(
    "--backend", default="fp32", show_default=True, metavar="NAME", help="`bench backends`"
)
@click.option(
    "--data",
    metavar="NAME|PATH,..",
    help="Data sets, recordings files, SIM.toml; default: every data set here but untested ones.",
)
@click.option("--seed", default=0, show_default=True, metavar="N", help="Training seed.")
@click.option(
    "--out",
    default="results",
    show_default=True,
    type=click.Path(path_type=Path),
    help="Result folder; finished runs found there are reused.",
)
@click.option("--jobs", default=1, show_default=True, metavar="N", help="Processes for the fits.")
@click.option("--scheduler", metavar="tcp://..", help="A Dask scheduler for the fits instead.")
@click.option("--plot", type=click.Path(path_type=Path), help="Draw it to a .png, .svg or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the matrix as JSON.")
def command(
    model: str,
    backend: str,
    data: str | None,
    seed: int,
    out: Path,
    jobs: int,
    scheduler: str | None,
    plot: Path | None,
    as_json: bool,
) -> None:
    """Train a model on each data set and test it on each other.

    A row is what was trained on, a column what was tested on; figures are the mean absolute error
    left and, in brackets, before mitigation (m). On the diagonal: folds of whole links of one data
    set. The last row is trained on all others at once. Only columns that both have are read.
    """
    from bench.cli.run_view import RunView
    from bench.files import check_picture_name
    from bench.runner.transfer import transfer

    if plot is not None:
        check_picture_name(plot)
    sets = None if data is None else [name.strip() for name in data.split(",") if name.strip()]
    with RunView(quiet=as_json) as view:
        matrix = transfer(
            model, backend, sets, seed=seed, out=out, jobs=jobs, scheduler=scheduler,
            observer=view,
        )  # fmt: skip
    if plot is not None:
        from bench.runner.transfer_picture import save_matrix

        save_matrix(matrix, plot)
    if as_json:
        say(json.dumps(asdict(matrix), indent=1))
        return
    _print(matrix)
    if plot is not None:
        say(f"picture: {named(plot)}")


def _print(matrix: TransferMatrix) -> None:
    """Print a table for NLoS and one for LoS, then why cells are empty."""
    for kind, title in (("nlos", "NLoS rows"), ("los", "LoS rows")):
        rows = [
            (train, *(_figure(getattr(matrix.cell(train, test), kind)) for test in matrix.data))
            for train in matrix.rows
        ]
        heading = f"{matrix.model} on {matrix.backend}, {title}: MAE left in m (before)"
        print_table(heading, ("trained on \\ tested on", *matrix.data), rows)
    reasons: dict[str, list[str]] = {}
    for one in (cell for cell in matrix.cells if cell.reason):
        reasons.setdefault(str(one.reason), []).append(f"{one.train} to {one.test}")
    for reason, pairs in reasons.items():
        say(f"{', '.join(pairs)}: {reason}")
    marked = sorted({one.test for one in matrix.cells if one.test_simulated})
    if marked:
        say(f"SIMULATED: {', '.join(marked)}")


def _figure(score: Score | None) -> str:
    return "-" if score is None else f"{score.mae_m.value:.3f} ({score.raw_mae_m:.3f})"
