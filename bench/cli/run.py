"""`bench run`: benchmark models on backends."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

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
  bench run --model remnet --backend fp32 --train apartment,rooms --test miluv
  bench run --model remnet --backend fp32 --data apartment --links 2,4,8 --plot curve.png
  bench run --model remnet --backend fp32 --pretrain rooms --finetune apartment:2,4,8
  bench run --model gp,npn,gbm --backend fp32 --data apartment --intervals 0.9
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
    "--train", metavar="NAME|PATH[,..]", help="Train on these (data sets, files, SIM.toml) ..."
)
@click.option("--test", metavar="NAME|PATH", help="... and test on this one.")
@click.option(
    "--links",
    metavar="K[,..]",
    help="Learning curve: train on K links of what is tested, test on others of its links.",
)
@click.option("--pretrain", metavar="NAME|PATH[,..]", help="Fit on these first ...")
@click.option(
    "--finetune", metavar="DATA:K[,..]", help="... then train further on K links of DATA."
)
@click.option(
    "--draws", default=5, show_default=True, metavar="N", help="How often the K links are drawn."
)
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    help="With --links or --finetune: draw the learning curve (.png, .svg, .pdf).",
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
@click.option(
    "--jobs",
    type=int,
    metavar="N",
    help="Processes for the fits. Default: the cores where fits are long, else this process.",
)
@click.option("--scheduler", metavar="tcp://..", help="A Dask scheduler for the fits instead.")
@click.option(
    "--no-wait",
    is_flag=True,
    help="Do not wait (up to two minutes) for a quiet machine to time on.",
)
@click.option("--no-timing", is_flag=True, help="Measure no latency.")
@click.option(
    "--guard",
    is_flag=True,
    help="Shrink corrections until unseen LoS links are no worse than raw (three more fits).",
)
@click.option(
    "--intervals",
    type=float,
    metavar="LEVEL",
    help="Also print intervals of the error that hold for new links, such as 0.9.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the records as JSON and nothing else.")
@click.pass_context
def command(
    context: click.Context,
    /,
    model: str,
    backend: str,
    plot: Path | None,
    no_wait: bool,
    no_timing: bool,
    intervals: float | None,
    as_json: bool,
    **rest: Any,
) -> None:
    """Benchmark models on backends and write the records.

    Reports MAE, R2 and sigma (m) for LoS and NLoS with 95 % intervals, measured latency (us) on
    this host, file and weight bytes, and latency (us) and energy (mJ) estimated per device.
    Interrupted? The same command finishes the rest.
    """
    from bench.cli.curve_view import print_curve
    from bench.cli.run_view import RunView, print_json, print_summary
    from bench.runner import run

    _check(context, plot)
    if intervals is not None and not 0 < intervals < 1:
        raise BenchError(f"--intervals {intervals}: expected a level between 0 and 1, such as 0.9")
    with RunView(quiet=as_json) as view:
        outcome: RunSet = run(
            model, backend, **rest, observer=view, wait=not no_wait, timed=not no_timing
        )
    if outcome.curve and not as_json:
        print_curve(outcome)
    else:
        (print_json if as_json else print_summary)(outcome)
    if plot is not None and outcome.curve:
        from bench.runner.curve_picture import save_curve

        save_curve(outcome.curve, plot)
    if intervals is not None and not as_json:
        from bench.cli.intervals_view import print_intervals

        print_intervals(outcome, intervals)
    if outcome.failures:
        raise _failed(outcome)
    if all(run.status == "skipped" for run in outcome.runs):
        raise _skipped(outcome)


def _check(context: click.Context, plot: Path | None) -> None:
    """Raise BenchError for options that do not go together."""
    from bench.files import check_picture_name

    said = {name for name in context.params if _was_said(context, name)}
    for named in {"test", "finetune"} & said:
        if "data" in said:
            raise BenchError(f"--data and --{named} both say what is tested; expected one of them")
    if plot is not None and not {"links", "finetune"} & said:
        raise BenchError("--plot draws a learning curve; expected --links or --finetune with it")
    if plot is not None:
        check_picture_name(plot)


def _was_said(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE


def _skipped(outcome: RunSet) -> BenchError:
    reasons = dict.fromkeys(f"{r.key.model} on {r.key.backend}: {r.reason}" for r in outcome.runs)
    return BenchError(f"nothing ran, every pair was skipped; {'; '.join(reasons)}")


def _failed(outcome: RunSet) -> BenchError:
    first = outcome.failures[0]
    count = len(outcome.failures)
    return BenchError(
        f"{count} run(s) failed; first: {first.model} on {first.backend}: {first.reason}"
    )
