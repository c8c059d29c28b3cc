"""`bench run`: benchmark models on backends."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.errors import BenchError

if TYPE_CHECKING:
    from bench.runner import RunSet

EPILOG = """\b
Examples:
  bench run --model remnet --backend int8
  bench run --model all --backend all --seeds 5 --out results
  bench run --model remnet,mlp --backend fp32 --data mine.parquet --split link-kfold:5
  bench run --model all --backend all --seeds 5 --jobs 4
"""


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option("--model", required=True, metavar="NAME[,..]|all", help="See `bench models`.")
@click.option("--backend", required=True, metavar="NAME[,..]|all", help="See `bench backends`.")
@click.option(
    "--data",
    default="rooms",
    show_default=True,
    metavar="NAME|PATH",
    help="A data set (`bench data list`) or a recordings .parquet or .csv.",
)
@click.option(
    "--split",
    metavar="SPLIT",
    help="leave-environment-out[:ENV] or link-kfold[:K]; default: what suits the data.",
)
@click.option(
    "--device",
    default="all",
    show_default=True,
    metavar="NAME[,..]|all",
    help="Devices (`bench devices`): all are estimated; named parts with a core are counted.",
)
@click.option("--seeds", default=1, show_default=True, metavar="N", help="Training seeds 0..N-1.")
@click.option(
    "--out",
    default="results",
    show_default=True,
    type=click.Path(path_type=Path),
    help="Result folder; finished runs found there are reused.",
)
@click.option("--jobs", default=1, show_default=True, metavar="N", help="Processes for the fits.")
@click.option("--scheduler", metavar="tcp://..", help="A Dask scheduler for the fits instead.")
@click.option(
    "--no-wait",
    is_flag=True,
    help="Do not wait (up to two minutes) for a quiet machine to time on.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the records as JSON and nothing else.")
def command(
    model: str,
    backend: str,
    data: str,
    split: str | None,
    device: str,
    seeds: int,
    out: Path,
    jobs: int,
    scheduler: str | None,
    no_wait: bool,
    as_json: bool,
) -> None:
    """Benchmark models on backends and write the records.

    Reports MAE, R2 and sigma (m) for LoS and NLoS with 95 % intervals, measured latency (us) on
    this host, file and weight bytes, and latency (us) and energy (mJ) estimated per device.
    Interrupted? The same command finishes the rest.
    """
    from bench.cli.run_view import RunView, print_json, print_summary
    from bench.runner import run

    with RunView(quiet=as_json) as view:
        outcome: RunSet = run(
            model, backend, data, split=split, device=device, seeds=seeds, out=out, jobs=jobs,
            scheduler=scheduler, observer=view, wait=not no_wait,
        )  # fmt: skip
    (print_json if as_json else print_summary)(outcome)
    if outcome.failures:
        raise _failed(outcome)


def _failed(outcome: RunSet) -> BenchError:
    first = outcome.failures[0]
    count = len(outcome.failures)
    return BenchError(
        f"{count} run(s) failed; first: {first.model} on {first.backend}: {first.reason}"
    )
